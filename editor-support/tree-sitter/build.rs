//! Compiles the generated parser.

fn main() {
    println!("cargo:rerun-if-changed=src/parser.c");
    let mut build = cc::Build::new();
    build.include("src").file("src/parser.c");
    // The tables are large; optimising them takes long and gains nothing.
    build.opt_level(0).warnings(false).compile("tree-sitter-rpi");
}
