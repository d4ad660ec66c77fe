// Starts `velour lsp` for shaders, and starts it again when its settings change.

const vscode = require('vscode');
const { LanguageClient } = require('vscode-languageclient/node');

/** @type {LanguageClient | undefined} */
let client;

/** The settings, as the server takes them. */
function settings() {
    const config = vscode.workspace.getConfiguration('velour');
    const folder = vscode.workspace.workspaceFolders?.[0]?.uri.fsPath ?? '';
    const whole = (text) => text.replaceAll('${workspaceFolder}', folder);
    return {
        command: whole(config.get('path') || 'velour'),
        options: { includeFolders: config.get('includeFolders', []).map(whole), defines: config.get('defines', []) },
    };
}

async function start() {
    const { command, options } = settings();
    client = new LanguageClient(
        'velour',
        'velour',
        { command, args: ['lsp'] },
        {
            documentSelector: [{ language: 'osl' }],
            initializationOptions: options,
            synchronize: { fileEvents: vscode.workspace.createFileSystemWatcher('**/*.{osl,oslh,h}') },
        },
    );
    try {
        await client.start();
    } catch (error) {
        client = undefined;
        const choice = await vscode.window.showErrorMessage(
            `velour: ${command} lsp does not start: ${error.message ?? error}. Install it with "cargo install velour", or say where it is.`,
            'Open settings',
        );
        if (choice) {
            await vscode.commands.executeCommand('workbench.action.openSettings', 'velour.path');
        }
    }
}

async function stop() {
    const running = client;
    client = undefined;
    await running?.stop();
}

async function restart() {
    await stop();
    await start();
}

async function activate(context) {
    context.subscriptions.push(
        vscode.commands.registerCommand('velour.restart', restart),
        vscode.workspace.onDidChangeConfiguration((event) => event.affectsConfiguration('velour') && restart()),
    );
    await start();
}

module.exports = { activate, deactivate: stop };
