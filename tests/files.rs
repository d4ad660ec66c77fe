//! Finished files: links are followed, modes and names kept, pipes get the bytes, and no failure costs the file that was there.
#![cfg(unix)]

use std::fs;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
use std::path::Path;
use velour::files::Destination;

fn write(path: &Path, text: &str) -> io::Result<()> {
    Destination::at(path)?.write(|sink| {
        // What comes first may be known last, as in an EXR.
        sink.write_all(&vec![b'?'; text.len()])?;
        sink.seek(SeekFrom::Start(0))?;
        sink.write_all(text.as_bytes())
    })
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = entries.collect();
    names.sort();
    names
}

#[test]
fn links_are_followed_and_modes_and_names_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("far")).unwrap();
    fs::write(at("far/old"), "old").unwrap();
    fs::set_permissions(at("far/old"), fs::Permissions::from_mode(0o640)).unwrap();
    symlink("far/old", at("link")).unwrap();
    symlink("link", at("link2")).unwrap();
    symlink("far/new", at("dangling")).unwrap();
    fs::write(at("one"), "a longer text than the new one").unwrap();
    fs::hard_link(at("one"), at("two")).unwrap();
    for name in ["link2", "dangling", "one", "plain"] {
        write(&at(name), name).unwrap();
        assert_eq!(fs::read_to_string(at(name)).unwrap(), name);
    }
    assert!(["link", "link2", "dangling"].iter().all(|name| at(name).is_symlink()));
    assert_eq!(fs::read_to_string(at("far/old")).unwrap(), "link2");
    assert_eq!(fs::metadata(at("far/old")).unwrap().permissions().mode() & 0o777, 0o640);
    assert_eq!(fs::read_to_string(at("two")).unwrap(), "one");
    assert_eq!(fs::metadata(at("one")).unwrap().ino(), fs::metadata(at("two")).unwrap().ino());
    // The mode of a new file is that of any other.
    fs::write(at("usual"), "").unwrap();
    let mode = |name: &str| fs::metadata(at(name)).unwrap().permissions().mode();
    assert_eq!(mode("plain"), mode("usual"));
    assert_eq!(names(folder.path()), ["dangling", "far", "link", "link2", "one", "plain", "two", "usual"]);
    assert_eq!(names(&at("far")), ["new", "old"]);
}

#[test]
fn a_pipe_gets_the_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || {
            let mut text = String::new();
            fs::File::open(pipe).unwrap().read_to_string(&mut text).unwrap();
            text
        }
    });
    write(&pipe, "through").unwrap();
    assert_eq!(reader.join().unwrap(), "through");
    assert!(!fs::metadata(&pipe).unwrap().is_file());
    assert!(write(Path::new("/dev/full"), "x").is_err());
    write(Path::new("/dev/null"), "x").unwrap();
}

#[test]
fn a_failure_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let (old, twin) = (folder.path().join("old"), folder.path().join("twin"));
    let fail = |path: &Path| {
        Destination::at(path)?.write(|sink| {
            sink.write_all(&[0; 100_000])?;
            Err(io::Error::other("the encoder has failed"))
        })
    };
    fs::write(&old, "old").unwrap();
    assert_eq!(fail(&old).unwrap_err().to_string(), "the encoder has failed");
    fs::hard_link(&old, &twin).unwrap();
    assert!(fail(&old).is_err() && fail(&folder.path().join("new")).is_err());
    assert_eq!(fs::read_to_string(&old).unwrap(), "old");
    assert_eq!(names(folder.path()), ["old", "twin"]);
    assert!(Destination::at(folder.path()).is_err());
    assert!(Destination::at(&folder.path().join("none/file")).is_err());
    let circle = folder.path().join("circle");
    symlink("circle", &circle).unwrap();
    assert!(Destination::at(&circle).is_err());
}

/// A disk of a megabyte, where this process may mount one.
struct Disk(tempfile::TempDir);

impl Disk {
    fn new() -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let mount = ["-t", "tmpfs", "-o", "size=1m", "none"];
        let mounted = std::process::Command::new("mount").args(mount).arg(folder.path()).output();
        let there = mounted.is_ok_and(|ran| ran.status.success());
        if !there {
            println!("skipped: no disk can be mounted here");
        }
        there.then(|| Disk(folder))
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = std::process::Command::new("umount").arg(self.0.path()).output();
    }
}

#[test]
fn room_that_is_held_is_there_when_the_disk_is_full() {
    let Some(disk) = Disk::new() else { return };
    let at = |name: &str| disk.0.path().join(name);
    let hold = |name: &str, bytes: u64| Destination::at(&at(name)).unwrap().hold(bytes);
    let error = hold("large", 2 << 20).unwrap_err();
    assert_eq!(error.kind(), io::ErrorKind::StorageFull);
    let room = hold("picture", 600 << 10).unwrap();
    assert!(room.is_held());
    assert_eq!(names(disk.0.path()), Vec::<String>::new());
    // Others take what is left.
    let bytes = vec![1; 1 << 20];
    assert!(fs::write(at("others"), &bytes).is_err());
    assert!(write(&at("without"), &"x".repeat(500 << 10)).is_err());
    room.write(|sink| sink.write_all(&bytes[..500 << 10])).unwrap();
    assert_eq!(fs::read(at("picture")).unwrap(), bytes[..500 << 10]);
    // What was not needed is given back.
    fs::write(at("more"), &bytes[..90 << 10]).unwrap();
    assert_eq!(names(disk.0.path()), ["more", "others", "picture"]);
}

#[test]
fn room_is_given_back_and_nothing_is_held_for_what_is_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("one"), "old").unwrap();
    fs::hard_link(at("one"), at("two")).unwrap();
    fs::write(at("old"), "old").unwrap();
    for (name, never) in [("one", true), ("old", false), ("new", false)] {
        let room = Destination::at(&at(name)).unwrap().hold(1 << 20).unwrap();
        assert!(!(never && room.is_held()));
        room.write(|sink| sink.write_all(b"few")).unwrap();
        let found = fs::metadata(at(name)).unwrap();
        assert!(found.len() == 3 && found.blocks() * 512 <= 1 << 16, "{name}: {} blocks", found.blocks());
    }
    assert_eq!(fs::read_to_string(at("two")).unwrap(), "few");
    let room = Destination::at(Path::new("/dev/null")).unwrap().hold(u64::MAX).unwrap();
    assert!(!room.is_held());
    assert_eq!(names(folder.path()), ["new", "old", "one", "two"]);
}
