//! Nothing stays in a machine: neither the registers of dropped groups nor the strings of past batches.

use velour::closure::reading::Value;
use velour::compile::{Compiler, Shader};
use velour::exec::{Machine, Points, Values};
use velour::lang::symbols::Symbol;

fn shader(text: &str) -> Shader {
    Compiler::new().compile("m.osl", text).unwrap_or_else(|e| panic!("{e}"))
}

/// Resident memory of this process in bytes, where the system tells it.
fn resident() -> Option<usize> {
    let pages = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(pages.split(' ').nth(1)?.parse::<usize>().ok()? * 4096)
}

/// A group with its own value of a parameter, shaded over 512 points and dropped.
fn built_and_shaded(shader: &Shader, machine: &mut Machine, number: u32) {
    let group = shader.group().param("k", &[f64::from(number)]).build().unwrap();
    machine.shade(&group, &Points::new(512));
}

/// Runs one test of this file in a process of its own, where no other test uses memory.
fn alone(name: &str) -> bool {
    const ALONE: &str = "VELOUR_TEST_ALONE";
    if std::env::var_os(ALONE).is_some() {
        return true;
    }
    let this = std::env::current_exe().unwrap();
    let ran =
        std::process::Command::new(this).args(["--exact", name, "--test-threads=1"]).env(ALONE, "1").output().unwrap();
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stdout));
    false
}

#[test]
fn dropped_groups_leave_nothing() {
    if !alone("dropped_groups_leave_nothing") {
        return;
    }
    let text = "surface s(float k = 0) { float a[4] = {u, v, k, k * u}; Ci = a[(int)(u * 4)] * sheen(diffuse(N), N, color(v), k * u + noise(P)); }";
    let shader = shader(text);
    let mut machine = Machine::new();
    (0..500).for_each(|number| built_and_shaded(&shader, &mut machine, number));
    assert!(machine.groups_held() <= 1, "{}", machine.groups_held());
    let before = resident();
    (500..4500).for_each(|number| built_and_shaded(&shader, &mut machine, number));
    assert!(machine.groups_held() <= 1);
    if let (Some(before), Some(after)) = (before, resident()) {
        let grown = after.saturating_sub(before);
        assert!(grown < 8 << 20, "{grown} bytes more after 4,000 groups");
    }
}

#[test]
fn groups_that_live_keep_their_registers() {
    let shader = shader("shader s(float k = 0, output float x = 0) { x = k + u; }");
    let groups: Vec<_> =
        (0..3).map(|k| shader.group().param("k", &[f64::from(k)]).keep_outputs().build().unwrap()).collect();
    let mut machine = Machine::new();
    for group in &groups {
        machine.shade(group, &Points::new(1));
    }
    drop(groups[1].clone());
    built_and_shaded(&shader, &mut machine, 9);
    assert_eq!(machine.groups_held(), 4);
    for (k, group) in groups.iter().enumerate() {
        assert_eq!(machine.output(group, "x").unwrap().lane(0), Values::Floats(vec![k as f32]));
    }
}

#[test]
fn strings_of_a_batch_die_with_it() {
    let text = "surface s(output string t = \"\") { t = format(\"made of %.9g\", u); Ci = debug(t) + debug(concat(t, \"!\")); }";
    let group = shader(text).group().keep_outputs().build().unwrap();
    let mut machine = Machine::new();
    for batch in 0..400 {
        let mut points = Points::new(512);
        (0..512).for_each(|lane| points.u[lane] = (batch * 512 + lane) as f32);
        let tree = machine.shade(&group, &points);
        assert_eq!(tree.strings.len(), 2 * 512);
        // They stay readable until the next batch, as arguments of closures and as outputs.
        let wanted = format!("made of {}", batch * 512 + 77);
        let tags: Vec<_> = tree.lane(group.table(), 77).map(|leaf| leaf.get("tag")).collect();
        let longer = format!("{wanted}!");
        assert_eq!(tags, [Some(Value::String(&wanted)), Some(Value::String(&longer))]);
        assert_eq!(machine.output(&group, "t").unwrap().lane(77), Values::Strings(vec![&wanted]));
        assert!(Symbol::find(&wanted).is_none(), "it is not interned for ever");
    }
}

#[test]
fn strings_made_in_a_batch_equal_those_of_the_program() {
    let text = "shader s(output int x = 0) { string t = format(\"%d\", (int)(u * 3)); x = 100 * (t == \"2\") + 10 * (concat(t, \"a\") == \"1a\") + (t == substr(concat(\"z\", t), 1, 1)); }";
    let group = shader(text).group().keep_outputs().build().unwrap();
    let mut points = Points::new(3);
    points.u = vec![0.1, 0.5, 0.9];
    let mut machine = Machine::new();
    machine.shade(&group, &points);
    let got: Vec<_> = (0..3).map(|lane| machine.output(&group, "x").unwrap().lane(lane)).collect();
    assert_eq!(got, [1, 11, 101].map(|x| Values::Ints(vec![x])));
}

#[test]
fn strings_that_grow_without_end_are_given_up() {
    let text =
        "shader s() { string t = \"x\"; for (int i = 0; i < 60; ++i) t = concat(t, t); printf(\"%d\", strlen(t)); }";
    let group = shader(text).group().build().unwrap();
    let mut machine = Machine::new();
    machine.shade(&group, &Points::new(4));
    let reports = machine.take_reports();
    assert!(reports.len() == 1 && reports[0].is_fatal(), "{reports:?}");
    assert!(reports[0].to_string().contains("64 MB"), "{}", reports[0]);
}
