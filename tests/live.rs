//! `velour live` over HTTP: what its page is told while files are edited, and who is answered at all.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Nothing but light of one color, so that every pixel is that color.
const GLOW: &str = "surface glow(color c = color(1, 0.25, 0) [[string help = \"light\", float max = 2]], int on = 1)\n{\n    Ci = on * c * emission();\n}\n";

const ROOM: &str = r#"<World><Camera eye="0,0,4" look_at="0,0,0" fov="60" res="64 48"/>
    <ShaderGroup name="sky">shader glow layer1;</ShaderGroup><Background resolution="0"/>
    <ShaderGroup name="ball">float roughness 0.3; shader cloth layer1;</ShaderGroup><Sphere center="0,0,0" radius="0.3"/></World>"#;

/// The bytes of sRGB for the light of `GLOW`.
const ORANGE: [u8; 3] = [255, 137, 0];

/// How long anything may take on a machine that has other things to do.
const PATIENCE: Duration = Duration::from_secs(30);

/// A session, and what its page has been told.
struct Page {
    folder: tempfile::TempDir,
    child: Child,
    port: u16,
    version: u64,
    news: Value,
    pixels: Vec<u8>,
}

impl Drop for Page {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Page {
    fn new(file: &str) -> Page {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), "glow.osl", GLOW);
        write(folder.path(), "room.xml", ROOM);
        Page::of(folder, file)
    }

    fn of(folder: tempfile::TempDir, file: &str) -> Page {
        let mut command = Command::new(env!("CARGO_BIN_EXE_velour"));
        command.args(["live", file, "--port", "0", "--spp", "64", "--view", "srgb"]).current_dir(folder.path());
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        let rest = line.strip_prefix("http://127.0.0.1:").unwrap_or_else(|| panic!("{line}"));
        let port = rest.split('/').next().unwrap().parse().unwrap();
        Page { folder, child, port, version: 0, news: json!({}), pixels: Vec::new() }
    }

    fn write(&self, name: &str, text: &str) {
        write(self.folder.path(), name, text);
    }

    /// Status, head and body of an answer.
    fn ask(&self, request: &str) -> (u16, String, Vec<u8>) {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        let end = bytes.windows(4).position(|four| four == b"\r\n\r\n").unwrap();
        let head = String::from_utf8(bytes[..end].to_vec()).unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        (status, head, bytes[end + 4..].to_vec())
    }

    fn get(&self, path: &str) -> (u16, String, Vec<u8>) {
        self.ask(&format!("GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nConnection: close\r\n\r\n", self.port))
    }

    /// The status of a wish, with these headers besides.
    fn post(&self, path: &str, body: &Value, headers: &str) -> u16 {
        let body = body.to_string();
        let own = format!("Host: 127.0.0.1:{}\r\nConnection: close\r\nContent-Length: {}\r\n", self.port, body.len());
        self.ask(&format!("POST {path} HTTP/1.1\r\n{own}{headers}\r\n{body}")).0
    }

    fn wish(&self, path: &str, body: &Value) {
        assert_eq!(self.post(path, body, "Content-Type: application/json\r\n"), 200, "{path} {body}");
    }

    /// Waits for news, keeps them, and gives those that are new.
    fn next(&mut self) -> Value {
        let (status, _, body) = self.get(&format!("/next?after={}", self.version));
        assert_eq!(status, 200);
        let length = u32::from_le_bytes(body[..4].try_into().unwrap()) as usize;
        let told: Value = serde_json::from_slice(&body[4..4 + length]).unwrap();
        self.version = told["version"].as_u64().unwrap();
        let news = told["news"].as_object().unwrap();
        for (name, value) in news {
            self.news[name] = value.clone();
        }
        if body.len() > 4 + length {
            self.pixels = body[4 + length..].to_vec();
        }
        told["news"].clone()
    }

    /// Waits for news until they are as they should be.
    fn until(&mut self, what: &str, right: impl Fn(&Page) -> bool) {
        let begin = Instant::now();
        while !right(self) {
            assert!(begin.elapsed() < PATIENCE, "{what}: {} {:?}", self.news["status"], self.pixels.get(..4));
            self.next();
        }
    }

    /// The first pixel, in the corner.
    fn corner(&self) -> [u8; 3] {
        self.pixels.get(..3).map_or([0; 3], |bytes| bytes.try_into().unwrap())
    }

    fn state(&self) -> &str {
        self.news["status"]["state"].as_str().unwrap_or("")
    }

    fn trouble(&self) -> &str {
        self.news["status"]["trouble"].as_str().unwrap_or("")
    }

    fn first_picture(&mut self) {
        self.until("a first picture", |page| page.corner() == ORANGE);
    }
}

fn write(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).unwrap();
}

#[test]
fn an_edit_gives_another_picture() {
    let mut page = Page::new("room.xml");
    page.first_picture();
    page.until("the whole picture", |page| page.pixels.len() == 64 * 48 * 4);
    page.write("glow.osl", &GLOW.replace("1, 0.25, 0", "0, 1, 0.25"));
    page.until("the edited color", |page| page.corner() == [0, 255, 137]);
    // As vim saves: another file takes the name.
    page.write("other.osl", &GLOW.replace("1, 0.25, 0", "0.25, 0, 1"));
    std::fs::rename(page.folder.path().join("other.osl"), page.folder.path().join("glow.osl")).unwrap();
    page.until("the color of the file that was put in its place", |page| page.corner() == [137, 0, 255]);
    assert!(page.news["picture"]["waited"].as_f64().is_some());
    page.until("the end", |page| page.state() == "done");
    let samples = [0, 1].map(|k| page.news["picture"]["samples"][k].as_u64().unwrap());
    assert!(16 <= samples[0] && samples[1] <= 64, "{samples:?}");
    assert!(page.news["picture"]["error"].as_f64().unwrap() <= 0.002);
    // The scene itself: other pixels, another color.
    page.write("room.xml", &ROOM.replace("64 48", "32 20").replace("shader glow", "color c 0 0.25 0; shader glow"));
    page.until("the edited scene", |page| page.corner() == [0, 137, 0] && page.pixels.len() == 32 * 20 * 4);
}

#[test]
fn what_is_wrong_is_told_with_a_caret_and_the_picture_stays() {
    let mut page = Page::new("room.xml");
    page.first_picture();
    page.write("glow.osl", &GLOW.replace("emission", "emision"));
    page.until("the mistake", |page| page.state() == "wrong");
    assert!(page.trouble().contains("glow.osl:3:") && page.trouble().contains('^'), "{}", page.trouble());
    assert!(page.trouble().contains("emision"), "{}", page.trouble());
    assert_eq!(page.corner(), ORANGE);
    // Who comes now sees the last good picture and the message.
    page.version = 0;
    page.pixels.clear();
    page.next();
    assert_eq!((page.corner(), page.state()), (ORANGE, "wrong"));
    page.write("glow.osl", &GLOW.replace("1, 0.25, 0", "0, 1, 0.25"));
    page.until("the mended color", |page| page.corner() == [0, 255, 137] && page.state() != "wrong");
    assert_eq!(page.news["status"]["trouble"], Value::Null);
    // A scene that is none.
    page.write("room.xml", "<World><Sphere></World>");
    page.until("the broken scene", |page| page.state() == "wrong");
    assert!(page.trouble().contains("room.xml:1:"), "{}", page.trouble());
    page.write("room.xml", ROOM);
    page.until("the mended scene", |page| page.state() != "wrong" && page.corner() == [0, 255, 137]);
}

#[test]
fn a_file_may_go_and_come_back() {
    let mut page = Page::new("room.xml");
    page.first_picture();
    std::fs::remove_file(page.folder.path().join("glow.osl")).unwrap();
    page.until("the missing file", |page| page.state() == "wrong");
    assert!(page.trouble().contains("glow"), "{}", page.trouble());
    page.write("glow.osl", &GLOW.replace("1, 0.25, 0", "0, 0, 1"));
    page.until("the file that is back", |page| page.corner() == [0, 0, 255]);
}

#[test]
fn an_endless_loop_is_told_and_ended_by_the_next_edit() {
    let mut page = Page::new("room.xml");
    page.first_picture();
    let endless = GLOW.replace("    Ci", "    float x = u;\n    while (x < 2) { x = x * 0.5; }\n    Ci");
    page.write("glow.osl", &endless);
    page.until("the endless loop", |page| page.state() == "wrong");
    assert!(page.trouble().contains("glow.osl:"), "{}", page.trouble());
    assert_eq!(page.corner(), ORANGE);
    page.write("glow.osl", &GLOW.replace("1, 0.25, 0", "0, 1, 0.25"));
    page.until("the mended color", |page| page.corner() == [0, 255, 137]);
    // In the middle of one the next edit does not wait for it.
    page.write("glow.osl", &endless);
    std::thread::sleep(Duration::from_millis(200));
    page.write("glow.osl", &GLOW.replace("1, 0.25, 0", "1, 1, 1"));
    page.until("the next color", |page| page.corner() == [255; 3]);
}

#[test]
fn values_of_parameters_change_the_picture() {
    let mut page = Page::new("room.xml");
    page.first_picture();
    let groups = page.news["controls"]["groups"].as_array().unwrap();
    assert_eq!(groups.iter().map(|group| group["name"].as_str().unwrap()).collect::<Vec<_>>(), ["sky", "ball"]);
    let param = &groups[0]["layers"][0]["params"][0];
    assert_eq!(
        (&param["name"], &param["type"], &param["value"]),
        (&json!("c"), &json!("color"), &json!([1.0, 0.25, 0.0]))
    );
    assert_eq!(param["meta"], json!({"help": "light", "max": 2.0}));
    // Floats of the scene are told as numbers that are near them.
    let rough = groups[1]["layers"][0]["params"].as_array().unwrap().iter().find(|param| param["name"] == "roughness");
    assert!((rough.unwrap()["value"][0].as_f64().unwrap() - 0.3).abs() < 1e-6);
    let set = |name: &str, value: Value| json!({"group": 0, "layer": 0, "name": name, "value": value});
    page.wish("/set", &set("c", json!([0.25, 0.25, 1])));
    page.until("the color of the page", |page| page.corner() == [137, 137, 255]);
    page.wish("/set", &set("on", json!([0])));
    page.until("the dark", |page| page.corner() == [0; 3]);
    page.wish("/set", &set("on", Value::Null));
    page.until("the light", |page| page.corner() == [137, 137, 255]);
    // An edit of the text keeps what the page has set, but where it changes that very value.
    page.write("glow.osl", &GLOW.replace("Ci = on", "Ci = 4 * on"));
    page.until("four times the color of the page", |page| page.corner() == [255; 3]);
    page.write("glow.osl", &GLOW.replace("1, 0.25, 0", "0, 1, 0.25"));
    page.until("the color of the text", |page| page.corner() == [0, 255, 137]);
    page.wish("/set", &set("c", json!([1, 1, 1])));
    page.until("white", |page| page.corner() == [255; 3]);
    page.wish("/reset", &json!({}));
    page.until("the color of the text again", |page| page.corner() == [0, 255, 137]);
    page.wish("/screen", &json!({"stops": -2, "view": "srgb"}));
    page.until("two stops less", |page| page.corner() == [0, 137, 71]);
    // What fits nothing changes nothing.
    for value in [json!([1, 2]), json!(["red"]), json!([null]), json!(7), json!([])] {
        let status = page.post("/set", &set("c", value.clone()), "Content-Type: application/json\r\n");
        assert!(status == 200 || status == 400, "{value}");
    }
    page.wish("/set", &json!({"group": 99, "layer": 0, "name": "c", "value": [1, 1, 1]}));
    page.wish("/screen", &json!({"stops": 0, "view": "srgb"}));
    page.until("the same color", |page| page.corner() == [0, 255, 137]);
}

#[test]
fn a_pixel_tells_its_tree_and_lobes() {
    let mut page = Page::new("room.xml");
    page.first_picture();
    let (status, _, body) = page.get("/pixel?x=32&y=24");
    assert_eq!(status, 200);
    let found: Value = serde_json::from_slice(&body).unwrap();
    assert_eq!(found["name"], "ball");
    assert!(found["tree"].as_str().unwrap().contains("sheen ("), "{found}");
    let lobes: Vec<&str> =
        found["lobes"].as_array().unwrap().iter().map(|lobe| lobe["closure"].as_str().unwrap()).collect();
    assert_eq!(lobes, ["sheen", "diffuse"]);
    let sum = |k: usize| -> f64 {
        found["lobes"].as_array().unwrap().iter().map(|lobe| lobe["curve"][k].as_f64().unwrap()).sum()
    };
    let total = |k: usize| (0..3).map(|c| found["total"][c][k].as_f64().unwrap()).sum::<f64>() / 3.0;
    for k in [0, 30, 60, 330] {
        assert!((sum(k) - total(k)).abs() < 1e-4 && total(k) > 0.01, "{k}: {} {}", sum(k), total(k));
    }
    assert_eq!(total(180), 0.0);
    let (_, _, body) = page.get("/pixel?x=0&y=0");
    assert!(String::from_utf8_lossy(&body).contains("emission"));
    assert_eq!(page.get("/pixel?x=-1&y=0").0, 400);
    assert_eq!(page.get("/pixel?x=4000000000&y=0").0, 200);
}

#[test]
fn a_shader_alone_is_shown_and_verified() {
    let folder = tempfile::tempdir().unwrap();
    let text = "#include \"tint.h\"\nsurface mine(float gain = 1) { Ci = gain * TINT * diffuse(N); }\n";
    write(folder.path(), "my shader.osl", text);
    write(folder.path(), "tint.h", "#define TINT color(0.5, 0.1, 0.1)\n");
    let mut page = Page::of(folder, "my shader.osl");
    page.until("a picture", |page| page.pixels.len() > 4);
    let red = |page: &Page| {
        let sum = |c: usize| page.pixels.iter().skip(c).step_by(4).map(|&byte| u64::from(byte)).sum::<u64>();
        sum(0) as f64 / sum(2) as f64
    };
    let before = red(&page);
    // A file that it includes.
    page.write("tint.h", "#define TINT color(0.1, 0.1, 0.5)\n");
    page.until("the other tint", |page| red(page) < 0.9 * before);
    let first = page.news["controls"]["first"].clone();
    assert_eq!(page.news["controls"]["groups"][first.as_u64().unwrap() as usize]["name"], "mine");
    page.wish("/verify", &json!({"group": first}));
    page.until("a verdict", |page| page.news["verify"]["state"] == "done");
    let verify = &page.news["verify"];
    assert_eq!((&verify["passed"], &verify["shader"]), (&json!(true), &json!("mine")));
    assert!(verify["rows"].as_array().unwrap().iter().any(|row| row["check"] == "energy" && row["verdict"] == "pass"));
    page.wish("/set", &json!({"group": first, "layer": 0, "name": "gain", "value": [3]}));
    page.until("the gain", |page| page.news["status"]["set"] == 1 && page.state() != "wrong");
    page.wish("/verify", &json!({"group": first}));
    page.until("the other verdict", |page| {
        page.news["verify"]["state"] == "done" && page.news["verify"]["passed"] == false
    });
}

#[test]
fn only_the_own_page_is_answered() {
    let mut page = Page::new("room.xml");
    page.first_picture();
    let host = |host: &str, path: &str| {
        page.ask(&format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n")).0
    };
    let port = page.port;
    for path in ["/", "/next?after=0", "/page.js"] {
        assert_eq!(host(&format!("127.0.0.1:{port}"), path), 200);
        assert_eq!(host(&format!("localhost:{port}"), path), 200);
        for name in ["evil.example", &format!("evil.example:{port}"), "127.0.0.1:1", "127.0.0.1"] {
            assert_eq!(host(name, path), 403, "{name} {path}");
        }
    }
    let change = json!({"group": 0, "layer": 0, "name": "c", "value": [0, 0, 1]});
    for headers in [
        "Content-Type: application/json\r\nOrigin: http://evil.example\r\n",
        "Content-Type: application/json\r\nOrigin: null\r\n",
        "Content-Type: application/json\r\nSec-Fetch-Site: cross-site\r\n",
        "Content-Type: text/plain\r\n",
        "",
    ] {
        assert_eq!(page.post("/set", &change, headers), 403, "{headers}");
    }
    assert_eq!(
        page.post("/set", &change, &format!("Content-Type: application/json\r\nOrigin: http://127.0.0.1:{port}\r\n")),
        200
    );
    page.until("the one change that was allowed", |page| page.corner() == [0, 0, 255]);
    let (_, head, body) = page.get("/");
    assert!(head.contains("default-src 'none'") && head.contains("frame-ancestors 'none'"), "{head}");
    let text = String::from_utf8(body).unwrap();
    assert!(!text.contains("://") && !text.contains("style=") && !text.contains("<script>"), "{text}");
    assert_eq!(page.get("/no/../such").0, 404);
    assert_eq!(page.ask(&format!("PUT / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Type: application/json\r\nConnection: close\r\nContent-Length: 0\r\n\r\n")).0, 405);
    // A port that is taken is said to be.
    let mut second = Command::new(env!("CARGO_BIN_EXE_velour"));
    let told = second.args(["live", "room.xml", "--port", &port.to_string()]).output().unwrap();
    let text = String::from_utf8(told.stderr).unwrap();
    assert!(told.status.code() == Some(2) && text.contains("--port"), "{text}");
}

#[cfg(target_os = "linux")]
#[test]
fn nothing_listens_but_on_this_machine() {
    let mut page = Page::new("room.xml");
    page.first_picture();
    let folder = format!("/proc/{}/fd", page.child.id());
    let links = std::fs::read_dir(folder).unwrap().filter_map(|entry| std::fs::read_link(entry.unwrap().path()).ok());
    let sockets: Vec<String> =
        links.filter_map(|link| Some(link.to_str()?.strip_prefix("socket:[")?.strip_suffix(']')?.to_owned())).collect();
    let mut listening = 0;
    for table in ["tcp", "tcp6", "udp", "udp6"] {
        let Ok(text) = std::fs::read_to_string(format!("/proc/net/{table}")) else { continue };
        for line in text.lines().skip(1) {
            let words: Vec<&str> = line.split_whitespace().collect();
            let listens = words[3] == "0A" || table.starts_with("udp");
            if listens && sockets.iter().any(|socket| socket == words[9]) {
                listening += 1;
                assert_eq!((table, words[1]), ("tcp", format!("0100007F:{:04X}", page.port).as_str()));
            }
        }
    }
    assert_eq!(listening, 1);
}

#[cfg(unix)]
#[test]
fn a_signal_ends_it_within_a_second() {
    for text in
        [GLOW.to_owned(), GLOW.replace("    Ci", "    float x = u;\n    while (x < 2) { x = x * 0.5; }\n    Ci")]
    {
        let mut page = Page::new("room.xml");
        page.first_picture();
        page.write("glow.osl", &text);
        std::thread::sleep(Duration::from_millis(100));
        let begin = Instant::now();
        let id = page.child.id().to_string();
        assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        assert_eq!(page.child.wait().unwrap().code(), Some(130));
        assert!(begin.elapsed() < Duration::from_secs(1), "{:?}", begin.elapsed());
    }
}
