//! What tev is sent: packets as its own documentation has them, read here by hand.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// A picture as a viewer has it, and how often it was told of it.
#[derive(Clone, Debug, Default, PartialEq)]
struct Shown {
    size: [usize; 2],
    channels: Vec<String>,
    pixels: Vec<f32>,
    /// Times that its first line was written.
    updates: usize,
}

/// A packet, read from its start on.
struct Packet<'a>(&'a [u8]);

impl Packet<'_> {
    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        let (first, rest) = self.0.split_at(N);
        self.0 = rest;
        first.try_into().unwrap()
    }

    fn int(&mut self) -> usize {
        i32::from_le_bytes(self.bytes()) as usize
    }

    fn long(&mut self) -> usize {
        i64::from_le_bytes(self.bytes()) as usize
    }

    fn text(&mut self) -> String {
        let end = self.0.iter().position(|byte| *byte == 0).unwrap();
        let text = String::from_utf8(self.0[..end].to_vec()).unwrap();
        self.0 = &self.0[end + 1..];
        text
    }
}

/// Takes a packet into what is shown.
fn take(mut packet: Packet, shown: &mut BTreeMap<String, Shown>) {
    let kind = packet.bytes::<1>()[0];
    let _focus = packet.bytes::<1>();
    let name = packet.text();
    match kind {
        4 => {
            let size = [packet.int(), packet.int()];
            let count = packet.int();
            let channels: Vec<String> = (0..count).map(|_| packet.text()).collect();
            let pixels = vec![f32::NAN; size[0] * size[1] * count];
            shown.insert(name, Shown { size, channels, pixels, updates: 0 });
        }
        6 => {
            let image = shown.get_mut(&name).expect("it was made before");
            let count = packet.int();
            let channels: Vec<String> = (0..count).map(|_| packet.text()).collect();
            assert_eq!(channels, image.channels);
            let [x, y, width, height] = std::array::from_fn(|_| packet.int());
            let offsets: Vec<usize> = (0..count).map(|_| packet.long()).collect();
            let strides: Vec<usize> = (0..count).map(|_| packet.long()).collect();
            let data: Vec<f32> = packet.0.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
            for i in 0..width * height {
                let to = (y + i / width) * image.size[0] + x + i % width;
                (0..count).for_each(|c| image.pixels[to * count + c] = data[offsets[c] + i * strides[c]]);
            }
            packet.0 = &[];
            image.updates += usize::from(y == 0);
        }
        other => panic!("packet {other}"),
    }
    assert!(packet.0.is_empty());
}

/// Reads packets until there are so many pictures of a name, or the other side ends.
fn read(mut stream: TcpStream, most: usize) -> BTreeMap<String, Shown> {
    let (mut shown, mut length) = (BTreeMap::<String, Shown>::new(), [0; 4]);
    while shown.values().all(|image| image.updates < most) && stream.read_exact(&mut length).is_ok() {
        let mut packet = vec![0; u32::from_le_bytes(length) as usize - 4];
        if stream.read_exact(&mut packet).is_err() {
            break;
        }
        take(Packet(&packet), &mut shown);
    }
    shown
}

/// A viewer of one connection that looks at so many pictures: its address, and what it shows in the end.
fn viewer(most: usize) -> (String, Receiver<BTreeMap<String, Shown>>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let (send, receive) = channel();
    std::thread::spawn(move || {
        let (stream, _) = listener.accept().unwrap();
        let _ = send.send(read(stream, most));
    });
    (address, receive)
}

fn velour(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_velour")).args(arguments).current_dir(folder).output().unwrap()
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The floats of an EXR of velour's.
fn floats(path: &Path) -> Vec<f32> {
    let image = image::open(path).unwrap();
    image.to_rgb32f().into_raw()
}

#[test]
fn a_render_is_seen_while_it_grows_and_ends_as_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let (address, shown) = viewer(usize::MAX);
    let output = velour(
        folder.path(),
        &["render", "figure1", "-o", "a.exr", "--res", "320", "128", "--spp", "128", "--tev", &address],
    );
    assert!(output.status.success(), "{}", errors(&output));
    let shown = shown.recv().unwrap();
    let image = &shown["a.exr"];
    assert_eq!((shown.len(), image.size, &image.channels[..]), (1, [320, 128], &["R", "G", "B"].map(String::from)[..]));
    let file = floats(&folder.path().join("a.exr"));
    assert!(
        image.pixels.iter().zip(&file).all(|(a, b)| a.to_bits() == b.to_bits()) && image.pixels.len() == file.len()
    );
    assert!(image.updates > 1, "seen {} times", image.updates);
    // That somebody looks does not change the picture.
    let alone = velour(folder.path(), &["render", "figure1", "-o", "b.exr", "--res", "320", "128", "--spp", "128"]);
    assert!(alone.status.success() && floats(&folder.path().join("b.exr")) == file);
}

#[test]
fn large_pictures_go_in_pieces_with_alpha() {
    let folder = tempfile::tempdir().unwrap();
    let (address, shown) = viewer(usize::MAX);
    let size = ["--res", "1100", "500", "--spp", "1", "--alpha"];
    let output = velour(folder.path(), &[&["render", "figure1", "-o", "a.exr", "--tev", &address], &size[..]].concat());
    assert!(output.status.success(), "{}", errors(&output));
    let shown = shown.recv().unwrap();
    let image = &shown["a.exr"];
    let file = image::open(folder.path().join("a.exr")).unwrap().to_rgba32f().into_raw();
    assert!(image.channels.len() == 4 && image.pixels == file);
}

#[test]
fn a_viewer_that_is_not_there_or_leaves_is_told_of() {
    let folder = tempfile::tempdir().unwrap();
    let small = ["--res", "64", "32", "--spp", "4"];
    let nobody = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string();
    let output = velour(folder.path(), &[&["render", "figure1", "-o", "a.png", "--tev", &nobody], &small[..]].concat());
    assert_eq!(output.status.code(), Some(2));
    let text = errors(&output);
    assert!(
        text.starts_with(&format!("error: tev is not at {nobody}: ")) && text.contains("help: start it first"),
        "{text}"
    );
    assert!(!folder.path().join("a.png").exists());
    // One that leaves costs its picture and nothing else.
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let leaving = listener.local_addr().unwrap().to_string();
    let thread = std::thread::spawn(move || drop((listener.accept().unwrap(), listener)));
    let output = velour(
        folder.path(),
        &["render", "figure1", "-o", "a.png", "--tev", &leaving, "--res", "1000", "1000", "--spp", "1"],
    );
    thread.join().unwrap();
    let text = errors(&output);
    assert!(output.status.success() && folder.path().join("a.png").exists(), "{text}");
    assert!(text.contains(&format!("warning: tev at {leaving} shows no new picture: ")), "{text}");
}

#[test]
fn a_live_session_is_seen_without_a_page() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("glow.osl"), "surface glow() { Ci = color(4, 2, 1) * emission(); }").unwrap();
    std::fs::write(
        folder.path().join("room.xml"),
        r#"<World><Camera eye="0,0,4" look_at="0,0,0"/><ShaderGroup>shader glow sky;</ShaderGroup><Background/></World>"#,
    )
    .unwrap();
    let (address, shown) = viewer(1);
    let mut child = Command::new(env!("CARGO_BIN_EXE_velour"))
        .args(["live", "room.xml", "--port", "0", "--res", "32", "16", "--spp", "4", "--tev", &address])
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
    let shown = shown.recv_timeout(Duration::from_secs(60));
    child.kill().unwrap();
    child.wait().unwrap();
    let shown = shown.unwrap();
    let image = &shown["room.xml"];
    assert_eq!(image.size, [32, 16]);
    assert!(image.pixels.chunks(3).all(|pixel| pixel == [4.0, 2.0, 1.0]), "{:?}", &image.pixels[..3]);
}
