//! `rpic check` on real-world files (line ends, tabs, byte order marks, wide characters, several files), and `--fix`.

use std::path::Path;
use std::process::{Command, Output};

fn rpic(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rpic"))
        .args(args)
        .current_dir(folder)
        .env_remove("NO_COLOR")
        .output()
        .expect("it starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Creates a folder with the given files.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("it is written");
    }
    folder
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).expect("it is there")
}

#[test]
fn fixes_keep_line_ends_and_are_told_one_by_one() {
    let program = "node f (a, b: int) returns (y: bool)\r\n  y = a == b;\r\ntel\r\n";
    let folder = folder(&[("a.rpi", program)]);
    let output = rpic(folder.path(), &["check", "--fix", "a.rpi"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let fixed = "node f (a, b: int) returns (y: bool)\r\nlet\r\n  y = a = b;\r\ntel\r\n";
    assert_eq!(read(folder.path(), "a.rpi"), fixed);
    let stderr = text(&output.stderr);
    assert!(stderr.contains("a.rpi:2:9: fixed: write `=`"), "{stderr}");
    assert!(
        stderr.contains("a.rpi:1:37: fixed: insert `let`"),
        "{stderr}"
    );
    let left: Vec<_> = std::fs::read_dir(folder.path())
        .expect("readable")
        .collect();
    assert_eq!(left.len(), 1, "nothing is left behind");
}

#[test]
fn folders_stand_for_their_programs() {
    let files = [
        (
            "a.rpi",
            "node f (x: int) returns (y: int)\nlet\n  y = z;\ntel\n",
        ),
        (
            "b.lus",
            "node g (x: int) returns (y: int);\nlet\n  y=x;\ntel\n",
        ),
        (
            "c.rpi",
            "test \"one\"\nlet\n  assert first;\n  finish done when true;\ntel\n",
        ),
        ("notes.md", "no program"),
    ];
    let folder = folder(&files);
    let checked = rpic(folder.path(), &["check", ".", "--format", "short"]);
    assert_eq!(checked.status.code(), Some(1));
    let stdout = text(&checked.stdout);
    assert!(
        stdout.contains("a.rpi:3:7") && !stdout.contains("notes"),
        "{stdout}"
    );
    let formatted = rpic(folder.path(), &["fmt", "--check", "."]);
    assert_eq!(text(&formatted.stderr), "b.lus: not formatted\n");
    let tested = rpic(folder.path(), &["test", "."]);
    let stdout = text(&tested.stdout);
    assert!(stdout.contains("1 passed, 0 failed"), "{stdout}");
    let none = rpic(folder.path(), &["check", "target"]);
    assert_eq!(none.status.code(), Some(2));
}

#[test]
fn what_one_fix_uncovers_is_fixed_too() {
    let program = "node f (x: float) returns (y: float) {\n  y := x;\n}\n";
    let folder = folder(&[("a.rpi", program)]);
    let output = rpic(folder.path(), &["check", "--fix", "a.rpi"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let fixed = "node f (x: real) returns (y: real) let\n  y = x;\ntel\n";
    assert_eq!(read(folder.path(), "a.rpi"), fixed);
}

#[test]
fn files_that_are_used_are_fixed_with_the_one_that_uses_them() {
    let files = [
        (
            "main.rpi",
            "use part;\nnode f (x: int) returns (y: int)\nlet\n  y = twice(x)\ntel\n",
        ),
        (
            "part.rpi",
            "node twice (x: int) returns (y: int)\nlet\n  y := 2 * x;\ntel\n",
        ),
    ];
    let folder = folder(&files);
    let before = rpic(folder.path(), &["check", "main.rpi"]);
    assert_eq!(before.status.code(), Some(1));
    assert!(
        text(&before.stderr).contains("part.rpi:3:5"),
        "{}",
        text(&before.stderr)
    );
    let output = rpic(folder.path(), &["check", "--fix", "main.rpi"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(read(folder.path(), "part.rpi").contains("y = 2 * x;"));
    assert!(read(folder.path(), "main.rpi").contains("y = twice(x);"));
}

#[test]
fn what_is_not_sure_is_left_to_the_writer() {
    let program = "node f (x: real[m]) returns (y: bool)\nlet\n  y = x > 3.0;\ntel\n";
    let folder = folder(&[("a.rpi", program)]);
    let output = rpic(folder.path(), &["check", "--fix", "a.rpi"]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(read(folder.path(), "a.rpi"), program);
}

#[test]
fn places_are_right_behind_tabs_marks_and_wide_characters() {
    let program =
        "\u{feff}node f (x: real) returns (y: real)\nlet\n\ty = (* 机器人 e\u{301} *) z;\ntel\n";
    let folder = folder(&[("a.rpi", program)]);
    let short = rpic(folder.path(), &["check", "--format", "short", "a.rpi"]);
    assert!(
        text(&short.stdout).starts_with("a.rpi:3:19: error RPI1001"),
        "{}",
        text(&short.stdout)
    );
    let json = rpic(folder.path(), &["check", "--format", "json", "a.rpi"]);
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).expect("JSON");
    let start = &json["findings"][0]["labels"][0]["start"];
    assert_eq!(
        (&start["line"], &start["col"]),
        (&3.into(), &19.into()),
        "{start}"
    );
    assert_eq!(
        start["offset"].as_u64(),
        program.find("z;").map(|at| at as u64)
    );
}

#[test]
fn several_files_make_one_report() {
    let wrong = "node f (x: real) returns (y: real)\nlet\n  y = q;\ntel\n";
    let folder = folder(&[("a.rpi", wrong), ("b.rpi", wrong)]);
    for format in ["json", "sarif"] {
        let output = rpic(
            folder.path(),
            &["check", "--format", format, "a.rpi", "b.rpi"],
        );
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one value");
        let count = match format {
            "json" => report["findings"].as_array(),
            _ => report["runs"][0]["results"].as_array(),
        };
        assert_eq!(count.map(Vec::len), Some(2), "{report}");
    }
    let human = rpic(folder.path(), &["check", "a.rpi", "b.rpi"]);
    let human = text(&human.stderr);
    assert_eq!(human.matches("2 errors").count(), 1, "{human}");
    assert!(!human.contains('\u{1b}'), "no colours in a pipe: {human}");
}

#[test]
fn a_file_that_two_use_is_told_about_once() {
    let part = "node twice (x: int) returns (y: int)\nlet\n  y = 2 * z;\ntel\n";
    let main = "use part;\nnode f (x: int) returns (y: int)\nlet\n  y = twice(x);\ntel\n";
    let folder = folder(&[("a.rpi", main), ("b.rpi", main), ("part.rpi", part)]);
    let output = rpic(
        folder.path(),
        &["check", "--format", "short", "a.rpi", "b.rpi"],
    );
    assert_eq!(
        text(&output.stdout).lines().count(),
        1,
        "{}",
        text(&output.stdout)
    );
}

#[test]
fn the_worst_decides_how_it_ends() {
    let good = "node f (x: real) returns (y: real)\nlet\n  y = x;\ntel\n";
    let warned = "// odd\nnode f (x: real) returns (y: real)\nlet\n  y = x;\ntel\n";
    let wrong = "node f (x: real) returns (y: real)\nlet\n  y = q;\ntel\n";
    let folder = folder(&[
        ("good.rpi", good),
        ("warned.rpi", warned),
        ("wrong.rpi", wrong),
    ]);
    let status = |files: &[&str]| {
        rpic(folder.path(), &[&["check"], files].concat())
            .status
            .code()
    };
    assert_eq!(status(&["good.rpi"]), Some(0));
    assert_eq!(status(&["warned.rpi"]), Some(0));
    assert_eq!(status(&["good.rpi", "wrong.rpi", "warned.rpi"]), Some(1));
    assert_eq!(status(&["missing.rpi"]), Some(2));
}

/// An invalid `machine.toml` is an error; it must not silently be replaced by the default machine.
#[test]
fn a_machine_that_is_none_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.rpi");
    std::fs::write(&path, "const a = 1;\n").unwrap();
    let check = || {
        let mut rpic = std::process::Command::new(env!("CARGO_BIN_EXE_rpic"));
        let output = rpic.arg("check").arg(&path).output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let machine = folder.path().join("machine.toml");
    std::fs::create_dir(&machine).unwrap();
    assert!(check().contains("not a text file"));
    std::fs::remove_dir(&machine).unwrap();
    std::fs::write(&machine, "speed = 3\n").unwrap();
    let stderr = check();
    for part in [
        "machine.toml: ",
        "line 1: unknown field `speed`",
        "help: required is",
    ] {
        assert!(stderr.contains(part), "{part} in {stderr}");
    }
}

/// Types refer to frames by name, so two modules must not place a frame of the same name differently.
#[test]
fn frames_of_one_name_are_at_one_place() {
    let frame = |by: &str| format!("frame table in {by};\n");
    let pose = |x: &str| format!("base = pose({x}[m], 0[m], 0[m], 0[deg], 0[deg], 0[deg])");
    let part = |by: &str| {
        let uses =
            "node put (p: Pose(x in table)) returns (q: Pose(x in table))\nlet\n  q = p;\ntel\n";
        format!("frame base, room;\n{}{uses}", frame(by))
    };
    let main = |by: &str| {
        let uses =
            "node f (p: Pose(x in table)) returns (q: Pose(x in table))\nlet\n  q = put(p);\ntel\n";
        format!("use part;\nframe base, room;\n{}{uses}", frame(by))
    };
    let stderr_of = |own: &str, other: &str| {
        let files = folder(&[("main.rpi", &main(own)), ("part.rpi", &part(other))]);
        let output = rpic(files.path(), &["check", "main.rpi"]);
        text(&output.stderr)
    };
    assert_eq!(stderr_of(&pose("1"), &pose("1.0")), "");
    assert_eq!(stderr_of(&pose("1"), "base"), "");
    let poses = stderr_of(&pose("1"), &pose("2"));
    assert!(
        poses.contains("RPI1002") && poses.contains("is in two places"),
        "{poses}"
    );
    let parents = stderr_of("base", "room");
    assert!(parents.contains("here it is placed in `base`"), "{parents}");
}

/// Neither of the two modules takes precedence.
#[test]
fn a_name_of_two_modules_is_told_and_may_be_qualified() {
    let main = |k: &str| {
        format!("use a, b;\nnode f (x: int) returns (y: int)\nlet\n  y = x + {k};\ntel\n")
    };
    let (a, b) = ("const k: int = 7;\n", "const k: int = 9;\n");
    let folder = folder(&[
        ("a.rpi", a),
        ("b.rpi", b),
        ("m.rpi", &main("k")),
        ("n.rpi", &main("a::k + b::k")),
    ]);
    let output = rpic(folder.path(), &["check", "m.rpi"]);
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert_eq!(
        (
            stderr.matches("RPI1002").count(),
            stderr.matches("RPI1016").count()
        ),
        (2, 0),
        "{stderr}"
    );
    let output = rpic(folder.path(), &["check", "n.rpi"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
}

/// The file extension decides the language of an included file, whichever file includes it.
#[test]
fn a_program_includes_lustre() {
    let library = "node rem (x: int) returns (y: int);\nlet y = if x > 0 then x % 3 else 0; tel\n";
    let main =
        "include \"lib.lus\"\nnode f (x: int) returns (y: int)\nlet\n  y = rem(x) + 60 % 7;\ntel\n";
    let right = main.replace(" + 60 % 7", "");
    let folder = folder(&[
        ("lib.lus", library),
        ("wrong.rpi", main),
        ("right.rpi", &right),
    ]);
    let output = rpic(folder.path(), &["check", "wrong.rpi"]);
    let stderr = text(&output.stderr);
    assert!(stderr.contains("wrong.rpi:4"), "{stderr}");
    assert_eq!(stderr.matches("error RPI0016").count(), 1, "{stderr}");
    let output = rpic(folder.path(), &["check", "right.rpi"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
}

/// Formatting in place would change more than the layout of the file.
#[test]
fn only_plain_files_in_utf_8_are_formatted_in_place() {
    let folder = folder(&[]);
    let file = folder.path().join("a.lus");
    let latin = b"-- \xfcber\nnode f(x:int)returns(y:int);let y=x;tel\n";
    std::fs::write(&file, latin).expect("it is written");
    let output = rpic(folder.path(), &["fmt", "a.lus"]);
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
    assert_eq!(std::fs::read(&file).expect("it is there"), latin);
}

/// Ambiguous expressions, each used as the value of `z`, with flows `b, d: bool`, `n, width: int` and `r: real`.
const DOUBTFUL: &[&str] = &[
    "if b nand d then 1 else 0",
    "if b NAND d then 1 else 0",
    "if b xnor d then 1 else 0",
    "if b lor d then 1 else 0",
    "(n unwhen b) ?? 0",
    "F(width = n, k = 3)",
    "Pair(x = n, width = 3).x",
    "7 // widht\n  + 1",
    "7 # 2\n  + 1",
    "SINT#16#FF",
    "INT#16#FFFF",
    "300u8",
    "0xFFi8",
    "int (2.0 ** 3 ** 2)",
    "int (-r ** 2)",
    "n // 2",
];

#[test]
fn what_may_mean_several_things_is_not_mended_unasked() {
    for value in DOUBTFUL {
        let program = format!(
            "type Pair = struct {{ x: int; width: int }};\nfunction F (width, k: int) returns (y: int) let y = width + k; tel\n\
             node N (b, d: bool; n, width: int; r: real) returns (z: int)\nlet\n  z = {value};\ntel\n"
        );
        let folder = folder(&[("a.rpi", &program)]);
        rpic(folder.path(), &["check", "--fix", "a.rpi"]);
        assert_eq!(read(folder.path(), "a.rpi"), program, "{value}");
    }
}
