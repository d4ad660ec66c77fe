//! A host of one's own: what it gives to shaders point by point, what it is asked, and what it hears.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use velour::compile::{Compiler, GroupBuilder};
use velour::exec::*;
use velour::ops::matrix::{IDENTITY, Matrix};

/// Counts what it is asked and keeps what it hears.
#[derive(Default)]
struct Counting {
    spaces: AtomicUsize,
    attributes: AtomicUsize,
    heard: Mutex<Vec<Report>>,
}

impl Host for Counting {
    fn space(&self, name: &str, points: &Points) -> Option<Matrix> {
        self.spaces.fetch_add(1, Ordering::Relaxed);
        assert!(points.len > 0);
        let mut double = IDENTITY;
        (double[0], double[5], double[10]) = (2.0, 2.0, 2.0);
        if name == "double" { Some(double) } else { built_in_space(name) }
    }

    fn attribute(&self, asked: &AttributeRequest<'_>, answer: &mut AttributeAnswer<'_>) {
        self.attributes.fetch_add(1, Ordering::Relaxed);
        match (asked.object, asked.name) {
            // Differs from point to point, with its derivatives.
            ("", "stripe") => answer.lanes().iter().for_each(|&lane| {
                let (u, dx) = (asked.points.u[lane], asked.points.dudx[lane]);
                answer.floats(lane, &[u * u]);
                if asked.slopes {
                    answer.slopes(lane, &[2.0 * u * dx], &[0.0]);
                }
            }),
            ("", "name") => answer.lanes().iter().for_each(|&lane| answer.strings(lane, &[format!("point {lane}")])),
            // Only every other lane has it.
            ("", "odd") => {
                answer.lanes().iter().filter(|&lane| lane % 2 == 1).for_each(|&lane| answer.ints(lane, &[7]))
            }
            ("lamp", "power") => answer.all(&Attribute::Floats(vec![1.0, 2.0, 3.0])),
            _ => {}
        }
    }

    fn ray_type(&self, name: &str) -> i32 {
        if name == "mine" { 1 << 20 } else { 0 }
    }

    fn hear(&self, reports: &mut Vec<Report>) {
        let kept = reports.extract_if(.., |report| report.kind == ReportKind::Warning);
        self.heard.lock().unwrap().extend(kept);
    }
}

fn points(lanes: usize) -> Points {
    let mut points = Points::new(lanes);
    for lane in 0..lanes {
        points.u[lane] = 0.1 * lane as f32;
        points.dudx[lane] = 0.5;
        points.ray_type[lane] = if lane == 2 { 1 << 20 } else { 1 };
    }
    points
}

/// Shades a text over four points and gives the host, the machine and the group.
fn shaded(text: &str) -> (Arc<Counting>, Machine, Group) {
    let group = Compiler::new().compile("h.osl", text).unwrap_or_else(|e| panic!("{e}"));
    let group = group.group().keep_outputs().build().unwrap();
    let host = Arc::new(Counting::default());
    let mut machine = Machine::with_host(host.clone());
    machine.shade(&group, &points(4));
    (host, machine, group)
}

fn floats(machine: &Machine, group: &Group, name: &str) -> Vec<f32> {
    let lane = |lane| match machine.output(group, name).unwrap().lane(lane) {
        Values::Floats(values) => values,
        other => panic!("{other:?}"),
    };
    (0..4).flat_map(lane).collect()
}

#[test]
fn an_attribute_may_differ_from_point_to_point() {
    let text = "shader s(output float a = 0, output float dx = 0, output float dy = 0) {
        getattribute(\"stripe\", a); dx = Dx(3 * a); dy = Dy(a); }";
    let (host, machine, group) = shaded(text);
    let near = |name: &str, wanted: [f32; 4]| {
        let got = floats(&machine, &group, name);
        assert!(got.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6), "{name}: {got:?}");
    };
    near("a", [0.0, 0.01, 0.04, 0.09]);
    near("dx", [0.0, 0.3, 0.6, 0.9]);
    near("dy", [0.0; 4]);
    assert_eq!(host.attributes.load(Ordering::Relaxed), 1, "one question for four lanes");
}

#[test]
fn lanes_without_an_answer_keep_what_they_had() {
    let text = "shader s(output float a = 0, output string name = \"\", output float c = 0) {
        int k = 5; int found = getattribute(\"odd\", k); a = 10 * found + k; getattribute(\"name\", name);
        color power = 4; getattribute(\"lamp\", \"power\", power); float wrong = 9; getattribute(\"lamp\", \"power\", wrong);
        c = power[2] + wrong; }";
    let (_, machine, group) = shaded(text);
    assert_eq!(floats(&machine, &group, "a"), [5.0, 17.0, 5.0, 17.0]);
    assert_eq!(floats(&machine, &group, "c"), [12.0; 4]);
    let name = |lane| machine.output(&group, "s.name").unwrap().lane(lane);
    assert_eq!(name(3), Values::Strings(vec!["point 3"]));
    assert!(machine.output(&group, "t.name").is_none());
}

#[test]
fn names_that_differ_are_asked_once_each() {
    let text = "shader s(output float a = 0) { getattribute(u > .15 ? \"stripe\" : \"none\", a); }";
    let (host, machine, group) = shaded(text);
    let got = floats(&machine, &group, "a");
    assert!((got[2] - 0.04).abs() < 1e-6 && got[0] == 0.0 && got[1] == 0.0, "{got:?}");
    assert_eq!(host.attributes.load(Ordering::Relaxed), 2);
}

#[test]
fn spaces_and_ray_types_are_the_hosts() {
    let text = "shader s(output float a = 0, output int r = 0) {
        for (int i = 0; i < 5; ++i) a += transform(\"double\", \"common\", point(u, 0, 0))[0]; r = raytype(\"mine\") + raytype(\"camera\"); }";
    let (host, machine, group) = shaded(text);
    let got = floats(&machine, &group, "a");
    assert!((got[3] - 3.0).abs() < 1e-5 && got[0] == 0.0, "{got:?}");
    assert_eq!(host.spaces.load(Ordering::Relaxed), 2, "each space once a batch, however often it is named");
    let rays: Vec<Values> = (0..4).map(|lane| machine.output(&group, "r").unwrap().lane(lane)).collect();
    assert_eq!(rays, [0, 0, 1, 0].map(|bit| Values::Ints(vec![bit])));
}

#[test]
fn what_nobody_reads_is_never_asked() {
    let text = "shader s(output float a = 0) { float b; getattribute(\"stripe\", b); point q = transform(\"double\", P); a = u; }";
    let (host, ..) = shaded(text);
    assert_eq!((host.attributes.load(Ordering::Relaxed), host.spaces.load(Ordering::Relaxed)), (0, 0));
}

#[test]
fn reports_come_in_parts() {
    let compiler = Compiler::new();
    let text = "shader s() {\n  if (u > .25) warning(\"w %g\", u);\n  printf(\"p %g\\n\", u);\n  int k[2] = {0, 0}; k[(int)(u * 10)] = 1; printf(\"%d\", k[1]); }";
    let shader = compiler.compile("h.osl", text).unwrap();
    let group = GroupBuilder::new(compiler.closures.clone()).layer("upper", &shader).build().unwrap();
    let host = Arc::new(Counting::default());
    let mut machine = Machine::with_host(host.clone());
    machine.shade(&group, &points(4));
    let heard = host.heard.lock().unwrap();
    let [warning] = heard.as_slice() else { panic!("{heard:?}") };
    let place = ReportPlace {
        shader: "s".into(),
        layer: "upper".into(),
        file: "h.osl".into(),
        line: 2,
        column: 16,
        word: "warning".into(),
        layer_number: 0,
    };
    assert_eq!((&*warning.place, warning.lane, warning.text.as_str()), (&place, 3, "w 0.3"));
    assert_eq!(warning.to_string(), "h.osl:2:16: w 0.3");
    let left = machine.take_reports();
    let mistake = left.iter().find(|report| matches!(report.kind, ReportKind::Mistake(_))).unwrap();
    assert_eq!((mistake.lane, mistake.place.line, mistake.text.as_str()), (2, 4, "index 2 is outside 0..1"));
    assert_eq!(left.iter().filter(|report| report.kind == ReportKind::Output).count(), 8);
}

/// An element of an array, for each lane its own.
#[test]
fn an_element_of_an_attribute_is_asked_for_by_its_number() {
    let mut host = PlainHost::default();
    let mut add = |name: &str, value: Attribute| host.attributes.insert(name.to_owned(), value);
    add("weights", Attribute::Floats(vec![0.5, 1.5, 2.5]));
    add("tints", Attribute::Floats(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    add("names", Attribute::Strings(vec!["a".to_owned(), "b".to_owned()]));
    let text = r#"shader s(output float w = 9, output color c = 9, output string n = "", output int missing = 9) {
        int k = (int)(3 * u);
        int r = getattribute("weights", k, w);
        r = getattribute("", "tints", 1, c);
        r = getattribute("names", 1, n);
        float none = 7;
        missing = 10 * getattribute("weights", 3 + k, none) + getattribute("weights", -1, none) + (int)none;
    }"#;
    let group = Compiler::new().compile("s.osl", text).unwrap().group().keep_outputs().build().unwrap();
    let mut machine = Machine::with_host(Arc::new(host));
    let mut points = Points::new(3);
    points.u.copy_from_slice(&[0.1, 0.5, 0.9]);
    machine.shade(&group, &points);
    for lane in 0..3 {
        let of = |name: &str| machine.output(&group, name).unwrap().lane(lane);
        assert_eq!(of("w"), Values::Floats(vec![0.5 + lane as f32]));
        assert_eq!(of("c"), Values::Floats(vec![4.0, 5.0, 6.0]));
        assert_eq!(of("n"), Values::Strings(vec!["b"]));
        assert_eq!(of("missing"), Values::Ints(vec![7]));
    }
}
