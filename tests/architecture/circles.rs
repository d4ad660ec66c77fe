//! No file of a room may use another that uses it, by whatever way: groups of files in a circle, and one way round.

use crate::modules::Modules;
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// Files that use each other.
#[derive(Debug, PartialEq, Eq)]
pub struct Circle {
    /// Their paths, sorted.
    pub files: Vec<String>,
    /// One shortest way round: each file and the path that it uses of the next.
    pub way: Vec<(String, String)>,
}

/// The circles within each room, the part of a path before its first slash.
pub fn circles(modules: &Modules) -> Vec<Circle> {
    let room = |file: usize| modules.name(file).split('/').next().unwrap_or_default().trim_end_matches(".rs");
    let mut edges: Vec<BTreeMap<usize, String>> = (0..modules.len()).map(|file| modules.used(file)).collect();
    for (file, used) in edges.iter_mut().enumerate() {
        used.retain(|&to, _| room(to) == room(file));
    }
    let reached: Vec<BTreeSet<usize>> = (0..edges.len()).map(|file| reach(&edges, file)).collect();
    let mut circles = Vec::new();
    let mut seen: BTreeSet<usize> = BTreeSet::new();
    for file in 0..edges.len() {
        if !reached[file].contains(&file) || seen.contains(&file) {
            continue;
        }
        let members: BTreeSet<usize> =
            reached[file].iter().copied().filter(|&other| reached[other].contains(&file)).collect();
        seen.extend(&members);
        let way = members.iter().map(|&start| shortest(&edges, &members, start)).min_by_key(Vec::len).unwrap();
        let way = way.windows(2).map(|pair| (modules.name(pair[0]).to_owned(), edges[pair[0]][&pair[1]].clone()));
        circles.push(Circle {
            files: members.iter().map(|&member| modules.name(member).to_owned()).collect(),
            way: way.collect(),
        });
    }
    circles
}

/// Every file that one uses, however far.
fn reach(edges: &[BTreeMap<usize, String>], from: usize) -> BTreeSet<usize> {
    let (mut reached, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(file) = open.pop() {
        open.extend(edges[file].keys().copied().filter(|&to| reached.insert(to)));
    }
    reached
}

/// The shortest way from a file of a circle to itself, both ends named.
fn shortest(edges: &[BTreeMap<usize, String>], members: &BTreeSet<usize>, start: usize) -> Vec<usize> {
    let mut before: BTreeMap<usize, usize> = BTreeMap::new();
    let mut open = VecDeque::from([start]);
    while let Some(file) = open.pop_front() {
        for &to in edges[file].keys().filter(|to| members.contains(to)) {
            if to == start {
                let mut way = vec![start, file];
                while way[way.len() - 1] != start {
                    way.push(before[&way[way.len() - 1]]);
                }
                way.reverse();
                return way;
            }
            before.entry(to).or_insert_with(|| {
                open.push_back(to);
                file
            });
        }
    }
    vec![start]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;

    fn found(files: &[(&str, &str)]) -> Vec<Circle> {
        circles(&Modules::new(&files.iter().map(|(path, text)| Source::new(path, text)).collect::<Vec<_>>()))
    }

    #[test]
    fn a_made_up_circle_is_found_and_shown() {
        let found = found(&[
            ("r/a.rs", "use super::B; pub struct A;"),
            ("r/b.rs", "pub struct B(super::c::C);"),
            ("r/c.rs", "use crate::r::A; pub struct C; use super::d::D;"),
            ("r/d.rs", "pub struct D;"),
            ("r/mod.rs", "mod a; mod b; mod c; mod d; pub use a::A; pub use b::B;"),
        ]);
        let step = |file: &str, path: &str| (file.to_owned(), path.to_owned());
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].files, ["r/a.rs", "r/b.rs", "r/c.rs"]);
        let way = [step("r/a.rs", "super::B"), step("r/b.rs", "super::c::C"), step("r/c.rs", "crate::r::A")];
        assert_eq!(found[0].way, way);
    }

    #[test]
    fn a_parent_and_a_child_that_use_each_other_are_a_circle() {
        let child = ("r/a.rs", "pub fn go(x: super::Own) {}");
        assert_eq!(found(&[("r/mod.rs", "mod a; pub struct Own; fn f() { a::go(Own) }"), child]).len(), 1);
        assert_eq!(found(&[("r/mod.rs", "mod a; pub use a::go; pub struct Own;"), child]).len(), 0);
    }

    #[test]
    fn arrows_of_one_direction_and_of_other_rooms_are_none() {
        let tree = [("r/a.rs", "use super::b::B;"), ("r/b.rs", "pub struct B; use crate::q::Q;")];
        assert_eq!(found(&[&tree[..], &[("q.rs", "pub struct Q; use crate::r::b::B;")]].concat()), []);
    }
}
