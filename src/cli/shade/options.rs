//! The command line of `velour shade`, which means what testshade's means: the order of shaders and parameters counts, and a
//! word may begin with one dash or two.

use crate::cli::failure::Failure;
use crate::ops::working_space::WorkingSpace;
use std::path::PathBuf;

/// One of the words that build the group, in the order in which they were given.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// The name of the next layer.
    Layer(String),
    /// A value for a parameter of the next shader.
    Param(Value),
    /// A shader, which takes the name and the values before it.
    Shader(String),
    /// A shader made of statements that set `result` and `alpha`.
    Expr(String),
    /// From layer, output, to layer, input.
    Connect([String; 4]),
    /// A whole group as text, or the name of a file that has it.
    Group(String),
}

/// A value as the command line has it, with what follows the option after colons.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Value {
    /// The parameter's name.
    pub name: String,
    /// The value, numbers with commas between.
    pub text: String,
    /// The type, if `type=` says it.
    pub ty: Option<String>,
    /// True where userdata of the same name goes first: `interpolated=1`, `lockgeom=0`.
    pub interpolated: Option<bool>,
    /// True where the value may change after the group is built.
    pub interactive: bool,
}

/// Everything that a command line says.
#[derive(Clone, Debug)]
pub struct Options {
    /// What makes the group.
    pub steps: Vec<Step>,
    /// Values that change after the first iteration, with their layers.
    pub reparams: Vec<(String, Value)>,
    /// Values that the points bring along.
    pub userdata: Vec<Value>,
    /// Outputs, each with the file that it goes to; `null` for none.
    pub outputs: Vec<(String, PathBuf)>,
    /// Of numbers in files: `uint8`, `half` or `float`.
    pub format: Option<String>,
    /// Width and height of the grid.
    pub res: [u32; 2],
    /// Points at the centers of cells instead of at the corners.
    pub center: bool,
    /// Derivatives of P, u and v that differ from point to point.
    pub vary: [bool; 3],
    /// Factor and offset of u and v.
    pub scale: [f32; 2],
    /// See `scale`.
    pub offset: [f32; 2],
    /// Print outputs instead of saving them.
    pub print: bool,
    /// How often the grid is shaded.
    pub iters: u32,
    /// The ray type of all points.
    pub raytype: String,
    /// Threads; 0 for one a core.
    pub threads: usize,
    /// Report what is assigned and is not finite.
    pub watch: bool,
    /// What RGB means.
    pub colorspace: WorkingSpace,
    /// Compile without optimising.
    pub unoptimized: bool,
    /// Count parameters that userdata may fill as connected.
    pub userdata_isconnected: bool,
    /// Seconds that this may take.
    pub time: Option<f64>,
    /// Bytes that this may hold.
    pub memory: Option<u64>,
    /// The folder that everything read has to lie in.
    pub sandbox: Option<PathBuf>,
    /// Tell more.
    pub verbose: bool,
    /// Tell instructions and times.
    pub stats: bool,
    /// The group's name.
    pub groupname: String,
    /// Where the group's text is written to.
    pub archive: Option<PathBuf>,
    /// List layers and parameters before shading.
    pub query: bool,
    /// Layers that run first, in order, instead of the last.
    pub entries: Vec<String>,
    /// Folders to look for shaders in.
    pub path: Vec<PathBuf>,
    /// Folders of included files, macros set and unset.
    pub include: Vec<PathBuf>,
    /// See `include`.
    pub define: Vec<String>,
    /// See `include`.
    pub undefine: Vec<String>,
    /// Settings of OSL's shading system, `NAME=VALUE` with commas between.
    pub settings: Vec<(String, String)>,
    /// True when only the help was asked for.
    pub help: bool,
}

impl Options {
    /// Is a setting of OSL's on, as the last word on it says?
    pub fn is_set(&self, name: &str, otherwise: bool) -> bool {
        let last = self.settings.iter().rev().find(|(known, _)| known == name);
        last.map_or(otherwise, |(_, value)| value != "0")
    }
}

impl Default for Options {
    fn default() -> Self {
        Options {
            steps: Vec::new(),
            reparams: Vec::new(),
            userdata: Vec::new(),
            outputs: Vec::new(),
            format: None,
            res: [1, 1],
            center: false,
            vary: [false; 3],
            scale: [1.0; 2],
            offset: [0.0; 2],
            print: false,
            iters: 1,
            raytype: "camera".to_owned(),
            threads: 0,
            watch: false,
            colorspace: WorkingSpace::default(),
            unoptimized: false,
            userdata_isconnected: false,
            time: None,
            memory: None,
            sandbox: None,
            verbose: false,
            stats: false,
            groupname: String::new(),
            archive: None,
            query: false,
            entries: Vec::new(),
            path: Vec::new(),
            include: Vec::new(),
            define: Vec::new(),
            undefine: Vec::new(),
            settings: Vec::new(),
            help: false,
        }
    }
}

/// An option: its names without dashes, the words after it, and what it does. An option without a text does nothing here.
type Known = (&'static [&'static str], &'static [&'static str], &'static str);

const KNOWN: &[Known] = &[
    (&["g", "res"], &["XRES", "YRES"], "Size of the grid of points [default: 1 1]"),
    (&["center"], &[], "Points at the centers of the grid's cells instead of at its corners"),
    (&["param"], &["NAME", "VALUE"], "A value for the next shader; --param:type=float[2]:interpolated=1:interactive=1"),
    (&["layer"], &["NAME"], "The name of the next shader's layer"),
    (&["shader"], &["SHADER", "LAYER"], "A shader and the name of its layer"),
    (&["connect"], &["FROM", "OUTPUT", "TO", "INPUT"], "Connect two layers"),
    (&["group"], &["TEXT"], "A whole group as text, or a file that has it"),
    (&["groupname"], &["NAME"], "The group's name"),
    (&["expr"], &["CODE"], "Statements that set `result` (a color) and `alpha`"),
    (&["o"], &["OUTPUT", "FILE"], "Save an output; `null` computes it only"),
    (&["d", "od"], &["TYPE"], "Numbers in files: uint8, half or float"),
    (&["print"], &[], "Print the outputs of every point instead of saving them"),
    (&["userdata"], &["NAME", "VALUE"], "A value that points bring along; --userdata:type=color"),
    (&["userdata_isconnected"], &[], "Count parameters that userdata may fill as connected"),
    (&["raytype"], &["NAME"], "The ray type of all points [default: camera]"),
    (&["iters"], &["N"], "Shade the grid so often"),
    (&["reparam"], &["LAYER", "NAME", "VALUE"], "Change a value after the first time; --reparam:type=color"),
    (&["vary_pdxdy"], &[], "Let derivatives of P differ from point to point"),
    (&["vary_udxdy"], &[], "The same for u"),
    (&["vary_vdxdy"], &[], "The same for v"),
    (&["scaleuv", "scalest"], &["U", "V"], "Factors of u and v"),
    (&["offsetuv", "offsetst"], &["U", "V"], "Offsets of u and v"),
    (&["entry"], &["LAYER"], "Run this layer; given more than once, one after the other"),
    (&["oslquery"], &[], "List layers and their parameters"),
    (&["archivegroup"], &["FILE"], "Write the group as text"),
    (&["path"], &["DIRS"], "Folders to look for shaders in, with colons between"),
    (&["t"], &["N"], "Threads; 0 for one a core"),
    (&["colorspace"], &["NAME"], "What RGB means to the shaders: Rec709, ACEScg and others [default: Rec709]"),
    (&["debugnan"], &[], "Report what shaders assign and is no finite number"),
    (&["O0"], &[], "Compile without optimising"),
    (&["options"], &["LIST"], "Settings of OSL's shading system; those with a meaning here: searchpath:shader"),
    (&["time"], &["S"], "End with an error when this takes more than S seconds"),
    (&["memory"], &["BYTES"], "Bytes that this may hold, such as 2G or 512M; it ends when it needs more"),
    (&["sandbox"], &["DIR"], "Read no file outside of this folder, whatever input names"),
    (&["stats", "runstats"], &[], "Print instructions before and after optimising, and time a point"),
    (&["v"], &[], "Print the group and what is done"),
    (&["h", "help"], &[], "Print this"),
    (&["O1", "O2", "debug", "debug2", "llvm_debug", "batched", "profile", "warmup", "debuguninit"], &[], ""),
    (&["groupoutputs", "print-groupdata", "print-group-stats", "inbuffer", "no-output-placement", "optix"], &[], ""),
    (&["shadeimage", "noshadeimage", "raytype_opt", "use_rs_bitcode", "saveptx"], &[], ""),
    (&["texoptions", "llvm_opt", "entryoutput", "locale", "jbufferMB"], &["VALUE"], ""),
];

/// The text of `--help`.
pub fn help() -> String {
    let mut out = String::from(
        "Run shaders on a grid of points, print what they print, save what they put out\n\n\
         Usage: velour shade [OPTIONS] [SHADER]...\n\n\
         The square from (0, 0, 1) to (1, 1, 1) with N along z. Values of --param go to the shader after them.\n\n\
         Options:\n",
    );
    for (names, words, about) in KNOWN.iter().filter(|(_, _, about)| !about.is_empty()) {
        let dashed: Vec<String> = names.iter().map(|name| dashed(name)).collect();
        let words: String = words.iter().map(|word| format!(" <{word}>")).collect();
        out += &format!("  {}{words}\n          {about}\n", dashed.join(", "));
    }
    out += "  -I <DIR>, -D<NAME[=VALUE]>, -U<NAME>\n          Included files and macros\n";
    out += "\nThe other options of OSL's testshade are taken and change nothing.\n";
    out
}

fn dashed(name: &str) -> String {
    if name.len() == 1 || name == "od" || name == "O0" { format!("-{name}") } else { format!("--{name}") }
}

/// Reads a command line.
///
/// # Errors
/// An option that there is not, or one without the words that it needs.
pub fn parse(args: &[String]) -> Result<Options, Failure> {
    let mut options = Options::default();
    let mut rest = args.iter();
    while let Some(arg) = rest.next() {
        let bare = arg.strip_prefix("--").or_else(|| arg.strip_prefix('-')).filter(|bare| !bare.is_empty());
        let Some(bare) = bare else {
            options.steps.push(Step::Shader(arg.clone()));
            continue;
        };
        if let Some(macro_or_folder) = arg.strip_prefix('-').filter(|a| a.starts_with(['I', 'D', 'U'])) {
            compile_option(macro_or_folder, &mut rest, &mut options)?;
            continue;
        }
        let (name, modifiers) = bare.split_once(':').unwrap_or((bare, ""));
        let known = KNOWN.iter().find(|(names, ..)| names.contains(&name));
        let Some((names, words, _)) = known else {
            let all: Vec<&str> = KNOWN.iter().flat_map(|(names, ..)| names.iter().copied()).collect();
            let hint = crate::lang::nearest::nearest(name, &all)
                .map_or(String::new(), |n| format!("; did you mean {}?", dashed(n)));
            return Err(usage(format!("there is no option {arg}{hint}")));
        };
        let given: Vec<String> = rest.by_ref().take(words.len()).cloned().collect();
        if given.len() < words.len() {
            return Err(usage(format!("{arg} needs {}", words.join(" "))));
        }
        apply(names[0], modifiers, &given, &mut options)?;
    }
    if u64::from(options.res[0]) * u64::from(options.res[1]) > 1 << 26 {
        return Err(usage(format!("a grid of {} x {} points is too large", options.res[0], options.res[1])));
    }
    // Who asks what an expression is wants to see it.
    let expression = options.steps.iter().any(|step| matches!(step, Step::Expr(_)));
    if options.print && options.outputs.is_empty() && expression {
        options.outputs.push(("result".to_owned(), PathBuf::from("null")));
    }
    Ok(options)
}

fn usage(text: String) -> Failure {
    Failure::Usage(format!("error: {text}\n  help: velour shade --help lists the options"))
}

/// `-Ifolder`, `-I folder`, `-Dname=value`, `-Uname`.
fn compile_option(text: &str, rest: &mut std::slice::Iter<String>, options: &mut Options) -> Result<(), Failure> {
    let (letter, value) = text.split_at(1);
    let value = if value.is_empty() { rest.next().cloned() } else { Some(value.to_owned()) };
    let value = value.ok_or_else(|| usage(format!("-{letter} needs a value")))?;
    match letter {
        "I" => options.include.push(PathBuf::from(value)),
        "D" => options.define.push(value),
        _ => options.undefine.push(value),
    }
    Ok(())
}

fn apply(name: &str, modifiers: &str, given: &[String], options: &mut Options) -> Result<(), Failure> {
    match name {
        "g" => options.res = [size(&given[0])?, size(&given[1])?],
        "center" => options.center = true,
        "param" => options.steps.push(Step::Param(value(modifiers, &given[0], &given[1]))),
        "layer" => options.steps.push(Step::Layer(given[0].clone())),
        "shader" => {
            options.steps.extend([Step::Layer(given[1].clone()), Step::Shader(given[0].clone())]);
        }
        "connect" => {
            let ends = [given[0].clone(), given[1].clone(), given[2].clone(), given[3].clone()];
            options.steps.push(Step::Connect(ends));
        }
        "group" => options.steps.push(Step::Group(given[0].clone())),
        "groupname" => options.groupname = given[0].clone(),
        "expr" => options.steps.push(Step::Expr(given[0].clone())),
        "o" => options.outputs.push((given[0].clone(), PathBuf::from(&given[1]))),
        "d" => options.format = Some(given[0].clone()),
        "print" => options.print = true,
        "userdata" => options.userdata.push(value(modifiers, &given[0], &given[1])),
        "userdata_isconnected" => options.userdata_isconnected = true,
        "raytype" => options.raytype = given[0].clone(),
        "iters" => options.iters = number(&given[0])?,
        "reparam" => options.reparams.push((given[0].clone(), value(modifiers, &given[1], &given[2]))),
        "vary_pdxdy" => options.vary[0] = true,
        "vary_udxdy" => options.vary[1] = true,
        "vary_vdxdy" => options.vary[2] = true,
        "scaleuv" => options.scale = [number(&given[0])?, number(&given[1])?],
        "offsetuv" => options.offset = [number(&given[0])?, number(&given[1])?],
        "entry" => options.entries.push(given[0].clone()),
        "oslquery" => options.query = true,
        "archivegroup" => options.archive = Some(PathBuf::from(&given[0])),
        "path" => options.path.extend(given[0].split(':').map(PathBuf::from)),
        "t" => options.threads = number(&given[0])?,
        "colorspace" => {
            options.colorspace = WorkingSpace::from_name(&given[0]).ok_or_else(|| {
                let names = WorkingSpace::NAMES.join(", ");
                Failure::Usage(format!("error: there is no color space {}\n  help: one of {names}", given[0]))
            })?;
        }
        "debugnan" => options.watch = true,
        "O0" => options.unoptimized = true,
        "options" => settings(&given[0], options),
        "time" => options.time = Some(number(&given[0])?),
        "memory" => options.memory = Some(crate::cli::watch::bytes(&given[0]).map_err(usage)?),
        "sandbox" => options.sandbox = Some(PathBuf::from(&given[0])),
        "stats" => options.stats = true,
        "v" => options.verbose = true,
        "h" => options.help = true,
        // Taken so that command lines of testshade work; there is nothing that it could change.
        _ => {}
    }
    Ok(())
}

fn settings(list: &str, options: &mut Options) {
    for entry in list.split(',') {
        if let Some((name, value)) = entry.split_once('=') {
            options.settings.push((name.trim().to_owned(), value.trim().to_owned()));
        }
    }
}

fn number<T: std::str::FromStr>(text: &str) -> Result<T, Failure> {
    text.parse().map_err(|_| usage(format!("`{text}` is no number that fits here")))
}

/// A side of the grid; the limit keeps a slip of the pen from asking for all memory.
fn size(text: &str) -> Result<u32, Failure> {
    let size: u32 = number(text)?;
    if (1..=1 << 16).contains(&size) {
        Ok(size)
    } else {
        Err(usage(format!("a grid of {text} points is not possible")))
    }
}

fn value(modifiers: &str, name: &str, text: &str) -> Value {
    let mut value = Value { name: name.to_owned(), text: text.to_owned(), ..Value::default() };
    for (key, set) in modifiers.split(':').filter_map(|modifier| modifier.split_once('=')) {
        let yes = set.trim().parse::<i32>().is_ok_and(|x| x != 0);
        match key {
            "type" => value.ty = Some(set.to_owned()),
            "interpolated" => value.interpolated = Some(yes),
            "lockgeom" => value.interpolated = Some(!yes),
            "interactive" => value.interactive = yes,
            _ => {}
        }
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Options {
        parse(&text.split(' ').map(str::to_owned).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn a_command_line_of_testshade_is_read_in_its_order() {
        let options = parsed(
            "-g 64 32 -layer a --param:type=int:lockgeom=0 n -3 first --shader second b -connect a x b y -od half",
        );
        let value = Value { ty: Some("int".into()), interpolated: Some(true), ..value("", "n", "-3") };
        let expected = [
            Step::Layer("a".into()),
            Step::Param(value),
            Step::Shader("first".into()),
            Step::Layer("b".into()),
            Step::Shader("second".into()),
            Step::Connect(["a", "x", "b", "y"].map(str::to_owned)),
        ];
        assert_eq!(options.steps, expected);
        assert_eq!((options.res, options.format.as_deref()), ([64, 32], Some("half")));
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, says) in [
            ("--centre", "did you mean --center?"),
            ("-g 4", "-g needs XRES YRES"),
            ("-g 4 x", "`x` is no number"),
            ("-g 0 4", "a grid of 0 points"),
            ("-D", "-D needs a value"),
        ] {
            let args: Vec<String> = text.split(' ').map(str::to_owned).collect();
            let Err(Failure::Usage(message)) = parse(&args) else { panic!("{text}") };
            assert!(message.contains(says), "{message}");
        }
    }
}
