//! What README.md shows is what happens: its blocks are run, and what they print is compared with what stands there.
//!
//! - `sh`: each line is run; `cargo run --release --` stands for `velour`. Lines of `cargo` and `git` are left out.
//! - `text`: a transcript. `$ cat FILE` writes the file that is shown, `$ velour …` must print what follows; a line `…`
//!   stands for any lines more. A block without `$` shows lines of what the last command before it printed, in their order.
//! - `c`: a shader, or the inside of one with `tint` and `roughness` as parameters; it must compile without a word.
//! - `xml`: elements of a scene; they must load and render, with a group `blue` above them.
//! - `rust`: documentation tests of `src/lib.rs`.
//!
//! Times differ between machines and builds: a number before ` ns`, ` ms` or ` s` is no more than a number, and spaces
//! before it do not count. Everything else is compared as it is. Pictures are made with one sample a pixel.

use std::path::Path;
use std::process::Command;

/// One fenced block: the word after the fence, the line it begins on, its lines.
#[derive(Debug, PartialEq)]
struct Block<'t> {
    language: &'t str,
    line: usize,
    lines: Vec<&'t str>,
}

fn blocks(text: &str) -> Vec<Block<'_>> {
    let mut out: Vec<Block> = Vec::new();
    let mut open = false;
    for (number, line) in text.lines().enumerate() {
        match (line.strip_prefix("```"), open) {
            (Some(language), false) => out.push(Block { language, line: number + 1, lines: Vec::new() }),
            (None, true) => out.last_mut().unwrap().lines.push(line),
            (Some(_), true) | (None, false) => {}
        }
        open ^= line.starts_with("```");
    }
    out
}

/// The words of a line with the numbers of times left open.
fn without_times(line: &str) -> String {
    let words: Vec<&str> = line.split_whitespace().collect();
    let time = |i: usize| {
        let unit = words.get(i + 1).map(|unit| unit.trim_end_matches([',', ';', ':']));
        words[i].parse::<f64>().is_ok() && unit.is_some_and(|unit| ["ns", "ms", "s"].contains(&unit))
    };
    let shown = (0..words.len()).map(|i| if time(i) { "#" } else { words[i] });
    shown.collect::<Vec<_>>().join(" ")
}

/// Says how what is shown differs from what was printed.
fn compare(shown: &[&str], printed: &str) -> Result<(), String> {
    let mut printed = printed.lines();
    for line in shown {
        if *line == "…" {
            return Ok(());
        }
        let other = printed.next().unwrap_or("(nothing)");
        if without_times(line) != without_times(other) {
            return Err(format!("shown   {line}\nprinted {other}"));
        }
    }
    printed.next().map_or(Ok(()), |more| Err(format!("printed and not shown: {more}")))
}

/// A folder that looks like a checkout, in which the commands run.
struct Checkout(tempfile::TempDir);

impl Checkout {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        for from in ["shaders", "shaders/scenes"] {
            std::fs::create_dir(folder.path().join(from)).unwrap();
            for entry in std::fs::read_dir(root.join(from)).unwrap().map(|entry| entry.unwrap().path()) {
                if entry.is_file() {
                    std::fs::copy(&entry, folder.path().join(from).join(entry.file_name().unwrap())).unwrap();
                }
            }
        }
        Checkout(folder)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.path().join(name), text).unwrap();
    }

    /// Runs `velour` with the words of a line and gives its status and standard output, or its messages on failure.
    fn velour(&self, line: &str) -> (i32, String) {
        let mut arguments: Vec<&str> = line.split_whitespace().collect();
        if arguments[0] == "render" && !arguments.contains(&"--spp") {
            arguments.extend(["--spp", "1"]);
        }
        let command = Command::new(env!("CARGO_BIN_EXE_velour")).args(arguments).current_dir(self.0.path()).output();
        let output = command.unwrap();
        let text = if output.stdout.is_empty() { output.stderr } else { output.stdout };
        (output.status.code().unwrap(), String::from_utf8(text).unwrap())
    }

    /// Runs a transcript; gives what its last command printed.
    fn transcript(&self, block: &Block) -> Option<String> {
        let mut last = None;
        let starts = (0..block.lines.len()).filter(|&i| block.lines[i].starts_with("$ ")).collect::<Vec<_>>();
        for (k, &start) in starts.iter().enumerate() {
            let shown = &block.lines[start + 1..starts.get(k + 1).copied().unwrap_or(block.lines.len())];
            let command = &block.lines[start][2..];
            if let Some(file) = command.strip_prefix("cat ") {
                self.write(file, &format!("{}\n", shown.join("\n")));
            } else {
                let arguments = command.strip_prefix("velour ").expect("a command of velour");
                let (_, printed) = self.velour(arguments);
                if let Err(difference) = compare(shown, &printed) {
                    panic!("README.md:{}: {command}\n{difference}\nall of it:\n{printed}", block.line);
                }
                last = Some(printed);
            }
        }
        last
    }
}

/// Every line of an excerpt is in the text, in this order.
fn excerpt(block: &Block, printed: &str) {
    let mut lines = printed.lines().map(without_times);
    for shown in &block.lines {
        let found = lines.any(|line| line == without_times(shown));
        assert!(found, "README.md:{}: not printed: {shown}\nall of it:\n{printed}", block.line);
    }
}

#[test]
fn the_blocks_do_what_they_show() {
    let readme = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).unwrap();
    let place = Checkout::new();
    let (mut printed, mut run) = (String::new(), 0);
    for block in blocks(&readme) {
        let whole = block.lines.join("\n");
        match block.language {
            "sh" => {
                for line in &block.lines {
                    let Some(arguments) = line.strip_prefix("cargo run --release -- ").or(line.strip_prefix("velour "))
                    else {
                        assert!(line.starts_with("cargo ") || line.starts_with("git "), "{line}");
                        continue;
                    };
                    let (status, said) = place.velour(arguments);
                    assert_eq!(status, 0, "README.md:{}: {said}", block.line);
                    run += 1;
                }
            }
            "text" => match place.transcript(&block) {
                Some(text) => {
                    printed = text;
                    run += 1;
                }
                None => excerpt(&block, &printed),
            },
            "c" => {
                let inside = format!("surface s(color tint = 1, float roughness = 0.4)\n{{\n{whole}\n}}\n");
                place.write("block.osl", if whole.starts_with("surface ") { &whole } else { &inside });
                assert_eq!(place.velour("check block.osl"), (0, String::new()), "README.md:{}", block.line);
            }
            "xml" => {
                let group = "<ShaderGroup name=\"blue\">shader matte l1;</ShaderGroup>";
                place.write("block.xml", &format!("<World>{group}\n{whole}</World>"));
                let (status, said) = place.velour("render block.xml -o block.png --res 4 4");
                assert_eq!(status, 0, "README.md:{}: {said}", block.line);
            }
            "rust" => {}
            other => panic!("README.md:{}: no rule for blocks of {other:?}", block.line),
        }
    }
    assert!(run >= 3, "commands are run");
}

#[test]
fn the_rules_tell_a_change_from_a_slower_machine() {
    let text = "a\n```sh\nx\n```\nb\n```text\n$ y\nz\n```\n";
    let expected = [("sh", 2, vec!["x"]), ("text", 6, vec!["$ y", "z"])];
    assert_eq!(blocks(text), expected.map(|(language, line, lines)| Block { language, line, lines }));
    let shown = ["u and v: 20.2 ns a hit", "error 1e-4, 7 ns; fast"];
    assert_eq!(compare(&shown, "u and v:   9 ns a hit\nerror 1e-4, 7.5 ns; fast\n"), Ok(()));
    assert!(compare(&shown, "u and v: 9 ns a hit\nerror 2e-4, 7 ns; fast\n").is_err());
    assert!(compare(&shown, "u and v: some ns a hit\n").is_err());
    assert!(compare(&shown[..1], "u and v: 9 ns a hit\nmore\n").is_err());
    assert_eq!(compare(&["a", "…"], "a\nmore\n"), Ok(()));
}
