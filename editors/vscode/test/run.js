// Holds the grammar against snapshots, and the client against what it promises. `UPDATE_EXPECT=1 node test/run.js` writes the snapshots anew.

const assert = require('node:assert');
const fs = require('node:fs');
const Module = require('node:module');
const path = require('node:path');
const test = require('node:test');
const oniguruma = require('vscode-oniguruma');
const { INITIAL, Registry, parseRawGrammar } = require('vscode-textmate');

const home = path.join(__dirname, '..');
const shaders = path.join(home, '..', '..', 'shaders');
const read = (...parts) => fs.readFileSync(path.join(...parts), 'utf8');

async function grammar() {
    const wasm = fs.readFileSync(require.resolve('vscode-oniguruma/release/onig.wasm'));
    await oniguruma.loadWASM(wasm.buffer.slice(wasm.byteOffset, wasm.byteOffset + wasm.byteLength));
    const file = path.join(home, 'syntaxes', 'osl.tmLanguage.json');
    const registry = new Registry({
        onigLib: Promise.resolve({
            createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
            createOnigString: (text) => new oniguruma.OnigString(text),
        }),
        loadGrammar: async (name) => (name === 'source.osl' ? parseRawGrammar(read(file), file) : null),
    });
    return registry.loadGrammar('source.osl');
}

/** Each line of a text, and below it what its pieces are. */
function snapshot(grammar, text) {
    let state = INITIAL;
    const out = [];
    for (const line of text.split(/\r?\n/)) {
        const { tokens, ruleStack } = grammar.tokenizeLine(line, state);
        state = ruleStack;
        out.push(`> ${line}`.trimEnd());
        for (const { startIndex, endIndex, scopes } of tokens) {
            const piece = line.slice(startIndex, endIndex);
            const names = scopes.slice(1).map((scope) => scope.replace(/\.osl$/, ''));
            if (piece.trim() && names.length) {
                out.push(`  ${piece.trim()}  ${names.join(' ')}`);
            }
        }
    }
    return `${out.join('\n')}\n`;
}

const files = [
    [shaders, 'cloth.osl'],
    [shaders, 'velvet.osl'],
    [shaders, 'layers.osl'],
    [path.join(shaders, 'first'), 'silk.osl'],
    [__dirname, 'everything.osl'],
];

test('what pieces of shaders are', async (t) => {
    const osl = await grammar();
    for (const [folder, name] of files) {
        await t.test(name, () => {
            const found = snapshot(osl, read(folder, name));
            const kept = path.join(__dirname, 'snapshots', `${name}.txt`);
            if (process.env.UPDATE_EXPECT) {
                fs.writeFileSync(kept, found);
            }
            assert.strictEqual(found, read(kept));
        });
    }
});

test('every name in our shaders is something', async () => {
    const osl = await grammar();
    for (const name of fs.readdirSync(shaders).filter((name) => name.endsWith('.osl'))) {
        let state = INITIAL;
        for (const line of read(shaders, name).split('\n')) {
            const { tokens, ruleStack } = osl.tokenizeLine(line, state);
            state = ruleStack;
            for (const { startIndex, endIndex, scopes } of tokens) {
                const piece = line.slice(startIndex, endIndex);
                assert.ok(scopes.length > 1 || !/[A-Za-z0-9"]/.test(piece), `${name}: ${piece} in ${line}`);
            }
        }
    }
});

test('the client starts the server that the settings name', async () => {
    const started = [];
    const values = { path: '${workspaceFolder}/bin/velour', includeFolders: ['${workspaceFolder}/inc'], defines: ['A=1'] };
    const commands = {};
    const shown = [];
    const vscode = {
        workspace: {
            getConfiguration: () => ({ get: (name, otherwise) => values[name] ?? otherwise }),
            workspaceFolders: [{ uri: { fsPath: '/work' } }],
            createFileSystemWatcher: (pattern) => pattern,
            onDidChangeConfiguration: () => ({}),
        },
        commands: { registerCommand: (name, run) => (commands[name] = run), executeCommand: async () => {} },
        window: { showErrorMessage: async (text) => void shown.push(text) },
    };
    let fails = false;
    class LanguageClient {
        constructor(id, name, server, options) {
            Object.assign(this, { server, options });
        }
        async start() {
            if (fails) {
                throw new Error('there is no such file');
            }
            started.push(this);
        }
        async stop() {
            started.splice(started.indexOf(this), 1);
        }
    }
    const load = Module._load;
    Module._load = function (request, ...rest) {
        if (request === 'vscode') return vscode;
        if (request === 'vscode-languageclient/node') return { LanguageClient };
        return load.call(this, request, ...rest);
    };
    const extension = require('../extension.js');
    Module._load = load;
    await extension.activate({ subscriptions: [] });
    assert.strictEqual(started.length, 1);
    assert.deepStrictEqual(started[0].server, { command: '/work/bin/velour', args: ['lsp'] });
    assert.deepStrictEqual(started[0].options.initializationOptions, { includeFolders: ['/work/inc'], defines: ['A=1'] });
    await commands['velour.restart']();
    assert.strictEqual(started.length, 1);
    await extension.deactivate();
    assert.strictEqual(started.length, 0);
    fails = true;
    await commands['velour.restart']();
    assert.match(shown[0], /bin\/velour lsp does not start: there is no such file/);
});

test('the extension names files that are there', () => {
    const { contributes, main } = JSON.parse(read(home, 'package.json'));
    const paths = [main, ...contributes.grammars.map((g) => g.path), ...contributes.languages.map((l) => l.configuration)];
    for (const name of paths.filter((name) => name.endsWith('.json'))) {
        JSON.parse(read(home, name));
    }
    assert.ok(paths.every((name) => fs.existsSync(path.join(home, name))));
});
