//! External functions: programs that call C, in the core and in C.

#[path = "../support/mod.rs"]
mod support;

use std::path::{Path, PathBuf};
use std::process::Command;

use rpi_testkit::{report_skip, workspace_root};
use support::{output_text, rpi};

fn folder() -> PathBuf {
    workspace_root().join("crates/rpi/tests/external")
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

fn has_compiler() -> bool {
    let found = Command::new("cc").arg("--version").output().is_ok();
    if !found {
        report_skip("cc is not installed");
    }
    found
}

/// Runs a program on the table beside it with the external functions in `library`. Returns the messages of the run.
fn run(program: &str, library: &Path, more: &[&str]) -> String {
    let path = folder().join(program);
    let inputs = text(&path.with_extension("in.csv"));
    let (path, library) = (text(&path), text(library));
    let head = ["run", &path, "--inputs", &inputs, "--extern", &library];
    let output = rpi(&[&head[..], more].concat());
    let messages = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{messages}");
    let wanted = std::fs::read_to_string(Path::new(&path).with_extension("out.csv")).unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stdout), wanted);
    messages
}

#[test]
fn a_source_computes_the_functions_in_the_core_and_in_c() {
    if has_compiler() {
        let source = folder().join("functions.c");
        run("external.rpi", &source, &[]);
        for compiler in ["gcc -O2", "clang -O2"] {
            let target = ["--target", "c", "--cc", compiler];
            if Command::new(&compiler[..compiler.len() - 4])
                .arg("--version")
                .output()
                .is_err()
            {
                report_skip(&format!("{compiler} is not installed"));
                continue;
            }
            let messages = run("external.rpi", &source, &target);
            assert!(messages.contains("the same bits in C"), "{messages}");
        }
    }
}

#[test]
fn a_library_computes_imported_functions_of_lustre() {
    if !has_compiler() {
        return;
    }
    let temporary = tempfile::tempdir().unwrap();
    let library = temporary.path().join("libfunctions.so");
    let mut command = Command::new("cc");
    command.args(["-shared", "-fPIC", "-o"]).arg(&library);
    let built = command.arg(folder().join("functions.c")).status().unwrap();
    assert!(built.success());
    run("imported.lus", &library, &[]);
    let messages = run(
        "imported.lus",
        &library,
        &["--target", "c", "--cc", "cc -O1"],
    );
    assert!(messages.contains("the same bits in C"), "{messages}");
}

/// The emitted text and the code of the user are one program, in both languages and without warnings.
#[test]
fn the_emitted_text_calls_the_functions() {
    if !has_compiler() {
        return;
    }
    let temporary = tempfile::tempdir().unwrap();
    let path = folder().join("external.rpi");
    let node = rpi_driver::compile_node(
        &rpi_driver::read(&path).unwrap(),
        Some("Main"),
        rpi_driver::ClaimPolicy::Off,
        false,
    );
    let compiled = node.unwrap();
    let options = rpi_driver::emit::COptions {
        period_ns: 1_000_000,
        header: Some("main.h".to_owned()),
        line_directives: false,
        origin: String::new(),
    };
    let net = compiled.node.unwrap().net;
    let emitted = rpi_driver::emit::c(&net, &compiled.sources, &options).unwrap();
    assert!(
        emitted
            .header
            .contains("double weighted(const double *in1, int64_t in2);")
    );
    let description = "in1: x: real[m]^3, 3 values";
    assert!(emitted.header.contains(description), "{}", emitted.header);
    let write = |name: &str, text: &str| {
        std::fs::write(temporary.path().join(name), text).unwrap();
    };
    write("main.h", &emitted.header);
    write("main.c", &emitted.source);
    // The prototypes of the header and those of the user must agree.
    let functions = std::fs::read_to_string(folder().join("functions.c")).unwrap();
    write("functions.c", &format!("#include \"main.h\"\n{functions}"));
    for language in ["-std=c99", "-xc++ -std=c++17"] {
        let mut command = Command::new("cc");
        command.args([
            "-Wall",
            "-Wextra",
            "-Wconversion",
            "-Wshadow",
            "-pedantic",
            "-Werror",
        ]);
        command.args(language.split(' ')).args(["-c", "main.c"]);
        if language == "-std=c99" {
            command.arg("functions.c");
        }
        let output = command.current_dir(temporary.path()).output().unwrap();
        let messages = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{language}: {messages}");
    }
}

#[test]
fn functions_that_nothing_provides_are_an_error_with_the_way_out() {
    let path = folder().join("external.rpi");
    let inputs = text(&path.with_extension("in.csv"));
    let output = rpi(&["run", &text(&path), "--inputs", &inputs]);
    let messages = output_text(&output);
    assert_eq!(output.status.code(), Some(2), "{messages}");
    for part in [
        "RPI9104",
        "external.rpi:2:",
        "`Weighted`",
        "`Split`",
        "--extern FILE",
    ] {
        assert!(messages.contains(part), "{part}: {messages}");
    }
}

#[test]
fn an_error_in_a_function_ends_the_run_with_a_message() {
    if !has_compiler() {
        return;
    }
    let temporary = tempfile::tempdir().unwrap();
    let source = temporary.path().join("functions.c");
    let code = "#include <stdint.h>\n#include <stdlib.h>\nint64_t twice(int64_t n) { if (n == 2) { abort(); } return n; }\ndouble weighted(const double *x, int64_t n) { (void)n; return x[0]; }\n";
    std::fs::write(&source, code).unwrap();
    let path = folder().join("imported.lus");
    let inputs = text(&path.with_extension("in.csv"));
    let files = ["--inputs", &inputs, "--extern", &text(&source)];
    let output = rpi(&[&["run", &text(&path)][..], &files[..]].concat());
    let messages = output_text(&output);
    assert_eq!(output.status.code(), Some(2), "{messages}");
    assert!(
        messages.contains("external functions have failed"),
        "{messages}"
    );
}

/// A program may call the primitive itself. A signature that is none, or not that of its values, has no results.
#[test]
fn a_wrong_signature_has_no_results() {
    for signature in ["none", "f\nf\nx:real:3:array:real\ny:real:1:value:real"] {
        let text = format!(
            "node A (x: real) returns (y: real)\nvar r: real^1;\nlet\n  r, _, _ = Rpi::ExternalFunction([x], [1], [true], Signature: {signature:?}, Reals: 1);\n  y = r[0];\ntel\n"
        );
        let input = rpi_driver::Input {
            path: "direct.rpi".into(),
            kind: rpi_driver::InputKind::Rpi,
            bytes: text.into_bytes(),
        };
        let claims = rpi_driver::ClaimPolicy::Off;
        let node = rpi_driver::compile_node(&input, Some("A"), claims, false).unwrap();
        let Some(node) = node.node else { continue };
        let image = rpi_driver::emit::lower_for_c(&node.net, 1_000_000).unwrap();
        assert!(image.functions.is_empty());
    }
}
