//! The command and its parts: ranges and merges, signals, what is left by a render that was killed, and how one goes on.

use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

const BALL: &str = r#"<World><Camera eye="0,1,6" look_at="0,0,0" fov="40" res="96 64"/>
    <ShaderGroup>color radiance 0.4 0.5 0.7; shader sky l1;</ShaderGroup><Background resolution="32"/>
    <ShaderGroup>shader matte l1;</ShaderGroup><Sphere center="0,0,0" radius="1"/>
    <Quad corner="-9,-1,-9" edge_x="0,0,18" edge_y="18,0,0"/></World>"#;

/// A folder with a scene.
struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        let place = Place(tempfile::tempdir().unwrap());
        std::fs::write(place.path().join("ball.xml"), BALL).unwrap();
        place
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_velour"));
        command.args(line.split_whitespace()).current_dir(self.path()).stderr(Stdio::piped());
        command
    }

    /// Status and standard error.
    fn say(&self, line: &str) -> (i32, String) {
        told(self.command(line).output().unwrap())
    }

    /// Runs what must be done.
    fn done(&self, line: &str) -> String {
        let (status, text) = self.say(line);
        assert_eq!(status, 0, "{line}: {text}");
        text
    }
}

fn told(output: Output) -> (i32, String) {
    (output.status.code().unwrap_or(-1), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn parts_merge_into_the_file_of_one_render() {
    let place = Place::new();
    place.done("render ball.xml -o whole.exr --samples 0..12");
    for (name, range) in [("a", "0..3"), ("b", "3..10"), ("c", "10..12")] {
        place.done(&format!("render ball.xml -o {name}.exr --samples {range} -t 1"));
    }
    place.done("merge c.exr a.exr b.exr -o merged.exr --samples 0..12");
    assert!(place.read("whole.exr") == place.read("merged.exr"));
    for name in ["plain.exr", "plain.png"] {
        place.done(&format!("render ball.xml -o {name} --spp 12"));
        place.done(&format!("merge a.exr b.exr c.exr --picture -o merged-{name}"));
        assert!(place.read(name) == place.read(&format!("merged-{name}")), "{name}");
    }
    // Merges of merges; what is missing and what is twice.
    assert!(place.done("merge a.exr c.exr -o ac.exr").contains("samples 3..10 are missing"));
    assert!(place.done("merge ac.exr b.exr -o abc.exr").contains("samples 0..12"));
    assert!(place.read("whole.exr") == place.read("abc.exr"));
    let (status, text) = place.say("merge a.exr c.exr -o none.exr --samples 0..12");
    assert!(status == 1 && text.contains("samples 3..10 are missing"), "{text}");
    let (status, text) = place.say("merge ac.exr a.exr -o none.exr");
    assert!(status == 1 && text.contains("samples 0..3 would count twice"), "{text}");
    let (status, text) = place.say("merge plain.exr a.exr -o none.exr");
    assert!(status == 2 && text.contains("plain.exr is no part of a picture"), "{text}");
    let (status, text) = place.say("merge a.exr b.exr c.exr -o none.exr --samples 0..10");
    assert!(status == 1 && text.contains("samples 10..12 are there and were not asked for"), "{text}");
    // A share is its part of all samples.
    place.done("render ball.xml -o share.exr --spp 12 --share 2/3");
    place.done("render ball.xml -o range.exr --samples 4..8");
    assert!(place.read("share.exr") == place.read("range.exr"));
    place.done("render ball.xml -o seed.exr --samples 3..10 --seed 5");
    let (status, text) = place.say("merge a.exr seed.exr -o none.exr");
    assert!(status == 1 && text.contains("the seed is 5 and not 0"), "{text}");
    assert!(!place.path().join("none.exr").exists());
    // A part may go through a pipe, but does not come from one.
    let part = place.command("render ball.xml -o - --samples 3..10").stdout(Stdio::piped()).output().unwrap().stdout;
    assert!(part == place.read("b.exr"));
    assert!(Command::new("mkfifo").arg(place.path().join("pipe.exr")).status().unwrap().success());
    let (status, text) = place.say("merge pipe.exr -o none.exr");
    assert!(status == 2 && text.contains("no regular file"), "{text}");
    let (status, text) = place.say("merge a.exr -o a.exr --picture");
    assert!(status == 2 && text.contains("would lose its samples"), "{text}");
    // A part that lacks some goes on.
    place.done("render ball.xml --resume ac.exr -o ac.exr --spp 12");
    assert!(place.read("whole.exr") == place.read("ac.exr"));
}

#[test]
fn ranges_that_cannot_be_are_refused() {
    let place = Place::new();
    for (line, word) in [
        ("render ball.xml -o a.exr --samples 5..5", "holds no sample"),
        ("render ball.xml -o a.exr --samples 5", "write it as 0..64"),
        ("render ball.xml -o a.exr --samples 0..4,8..9", "one range"),
        ("render ball.xml -o a.png --samples 0..4", "which is an .exr"),
        ("render ball.xml -o a.exr --samples 0..4 --spp 4", "cannot be used with"),
        ("render ball.xml -o a.exr --share 1/2 --samples 0..4", "cannot be used with"),
        ("render ball.xml -o a.exr --share 0/2", "no share"),
        ("render ball.xml -o a.exr --share 1/9 --spp 4", "too few"),
        ("render ball.xml --resume none.exr", "none.exr is no part"),
        ("render ball.xml -o a.exr --checkpoint inf", "0.01"),
        ("render ball.xml -o a.exr --checkpoint=-1", "0.01"),
    ] {
        let (status, text) = place.say(line);
        assert!(status == 2 && text.contains(word), "{line}: {status} {text}");
    }
    assert!(!place.path().join("a.exr").exists());
}

/// A render that would not end by itself; it does not outlive its test.
struct Running(Option<Child>);

impl Running {
    fn signal(&self, name: &str) {
        let id = self.0.as_ref().map_or(0, Child::id).to_string();
        assert!(Command::new("kill").args([name, &id]).status().unwrap().success());
    }

    /// Waits for its end: status and standard error.
    fn end(mut self) -> (i32, String) {
        told(self.0.take().unwrap().wait_with_output().unwrap())
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if let Some(child) = &mut self.0 {
            let _ = child.kill();
        }
    }
}

/// Starts a render that does not end by itself soon, and waits until it listens: its first part is there.
fn start(place: &Place, line: &str, first_part: &str) -> Running {
    let child = Running(Some(place.command(line).spawn().unwrap()));
    let start = Instant::now();
    while !place.path().join(first_part).exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "no part after a minute");
        std::thread::sleep(Duration::from_millis(20));
    }
    child
}

#[test]
fn a_signal_leaves_a_picture_that_goes_on_to_the_same_bits() {
    let place = Place::new();
    for (name, status) in [("-INT", 130), ("-TERM", 143)] {
        let child = start(&place, "render ball.xml -o cut.exr --spp 40000000 --checkpoint 0.1 -t 1", "cut.exr");
        let asked = Instant::now();
        child.signal(name);
        let (found, text) = child.end();
        assert!(asked.elapsed() < Duration::from_secs(1), "{:?}", asked.elapsed());
        assert_eq!(found, status, "{text}");
        assert!(text.contains("stopped: cut.exr holds") && text.contains("--resume cut.exr"), "{text}");
        assert_goes_on(&place, "cut.exr");
        std::fs::remove_file(place.path().join("cut.exr")).unwrap();
    }
}

/// Holds that a part, gone on from until all pixels have as many samples as any, is what one render makes.
fn assert_goes_on(place: &Place, name: &str) {
    let part = velour::render::part::read(&place.path().join(name)).unwrap();
    let [fewest, most] = part.counts();
    assert!(most > 0 && fewest < 40_000_000, "{}", part.summary());
    place.done(&format!("render ball.xml --resume {name} --spp {most}"));
    place.done(&format!("render ball.xml -o control.exr --samples 0..{most}"));
    assert!(place.read("control.exr") == place.read(name));
}

#[test]
fn a_render_that_was_killed_goes_on_from_its_last_part() {
    let place = Place::new();
    let child = start(&place, "render ball.xml -o cut.exr --spp 40000000 --checkpoint 0.05", "cut.exr");
    child.signal("-KILL");
    child.end();
    assert_goes_on(&place, "cut.exr");
    // Nothing but the scene and the two files is there.
    assert_eq!(std::fs::read_dir(place.path()).unwrap().count(), 3);
}

#[test]
fn a_picture_that_is_no_exr_has_its_part_beside_it_until_it_is_done() {
    let place = Place::new();
    let child = start(&place, "render ball.xml -o cut.png --spp 40000000 --checkpoint 0.1", "cut.png.part.exr");
    child.signal("-INT");
    let (status, text) = child.end();
    assert!(status == 130 && text.contains("--resume cut.png.part.exr"), "{text}");
    assert!(place.read("cut.png").starts_with(b"\x89PNG"));
    place.done("render ball.xml --resume cut.png.part.exr -o cut.png --spp 5 --checkpoint 0");
    assert!(!place.path().join("cut.png.part.exr").exists());
}

#[test]
fn parts_on_the_way_do_not_show_and_let_the_work_go_on() {
    let place = Place::new();
    // Each look at the clock finds that a part is due.
    let start = Instant::now();
    place.done("render ball.xml -o cut.exr --samples 0..64 --checkpoint 0.01");
    assert!(start.elapsed() < Duration::from_secs(60));
    place.done("render ball.xml -o whole.exr --samples 0..64 --checkpoint 0");
    assert!(place.read("cut.exr") == place.read("whole.exr"));
    // Nor where a render that stops by noise has been cut.
    for (name, every) in [("one", "0"), ("two", "0.02")] {
        place.done(&format!("render ball.xml -o {name}.exr --noise 0.004 --checkpoint {every}"));
    }
    assert!(place.read("one.exr") == place.read("two.exr"));
    // A part that another render has left stays.
    std::fs::write(place.path().join("x.png.part.exr"), "of another").unwrap();
    place.done("render ball.xml -o x.png --spp 1");
    assert_eq!(place.read("x.png.part.exr"), b"of another");
}

#[test]
fn names_of_any_language_do_not_lose_a_picture() {
    let place = Place::new();
    std::fs::write(place.path().join("сцена.xml"), BALL).unwrap();
    place.done("render сцена.xml -o plain.exr --spp 1");
    place.done("render сцена.xml -o part.exr --samples 0..1");
    place.done("merge part.exr -o merged.exr --picture");
    assert!(place.read("plain.exr") == place.read("merged.exr"));
}

#[test]
fn a_time_ends_where_it_says_and_a_signal_ends_it_before() {
    let place = Place::new();
    // One sample of each pixel takes longer than the time there is.
    std::fs::write(
        place.path().join("slow.osl"),
        "surface slow() { float x = u; for (int i = 0; i < 3000; i++) x = pow(x + noise(P * i), .99); Ci = x * diffuse(N); }",
    )
    .unwrap();
    std::fs::write(place.path().join("slow.xml"), BALL.replace("shader matte", "shader slow")).unwrap();
    for (line, most) in [
        ("render slow.xml -o slow.exr --time 1 --res 1000 1000", 4.0),
        ("render ball.xml -o slow.exr --time 0.5 --res 2000 2000", 12.0),
    ] {
        let start = Instant::now();
        place.done(line);
        assert!(start.elapsed().as_secs_f64() < most, "{line}: {:?}", start.elapsed());
    }
    let child = start(&place, "render ball.xml -o cut.exr --time 600 --checkpoint 0.1", "cut.exr");
    child.signal("-TERM");
    let (status, text) = child.end();
    assert!(status == 143 && text.contains("stopped: cut.exr holds"), "{text}");
}

#[test]
fn a_disk_that_is_too_small_is_told_of_before_the_render_and_parts_that_fail_once() {
    let place = Place::new();
    let disk = place.path().join("disk");
    std::fs::create_dir(&disk).unwrap();
    let mount = Command::new("mount").args(["-t", "tmpfs", "-o", "size=1m", "none"]).arg(&disk).output();
    if !mount.is_ok_and(|ran| ran.status.success()) {
        println!("skipped: no disk can be mounted here");
        return;
    }
    let small = place.say("render ball.xml -o disk/a.exr --spp 1");
    let start = Instant::now();
    let (status, text) = place.say("render ball.xml -o disk/b.exr --res 1000 1000 --spp 40000000");
    let soon = start.elapsed() < Duration::from_secs(20);
    let child = place.command("render ball.xml -o disk/c.exr --res 400 400 --samples 0..8 --checkpoint 0.01 --no-hold");
    let (lost, rescued) = told({ child }.env("TMPDIR", place.path()).output().unwrap());
    let left: Vec<_> = std::fs::read_dir(&disk).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(Command::new("umount").arg(&disk).status().unwrap().success());
    assert_eq!(small.0, 0, "{}", small.1);
    assert!(status == 2 && soon && text.contains("may take 12 MB") && text.contains("--no-hold"), "{text}");
    // A first part may have had room.
    assert!(left.iter().all(|name| name == "a.exr" || name == "c.exr"), "{left:?}");
    assert!(lost == 2 && rescued.contains("its samples are in"), "{rescued}");
    assert_eq!(rescued.matches("was not kept").count(), 1, "{rescued}");
    assert!(rescued.contains("more parts for that reason"), "{rescued}");
}

#[test]
fn merges_stay_in_their_sandbox() {
    let place = Place::new();
    std::fs::create_dir(place.path().join("in")).unwrap();
    place.done("render ball.xml -o out.exr --samples 0..1");
    place.done("render ball.xml -o in/a.exr --samples 1..2");
    std::os::unix::fs::symlink("../out.exr", place.path().join("in/link.exr")).unwrap();
    place.done("merge in/a.exr -o b.exr --sandbox in --memory 1G");
    for part in ["out.exr", "in/link.exr"] {
        let (status, text) = place.say(&format!("merge in/a.exr {part} -o c.exr --sandbox in"));
        assert!(status == 2 && text.contains("sandbox") && !place.path().join("c.exr").exists(), "{text}");
    }
}
