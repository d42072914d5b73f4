//! Consistency of the name index with the checker. In a correct program, every name is in the index or needs no
//! declaration, and each reference in the index is an occurrence of the name.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use rpi_diag::FileId;
use rpi_driver::{DiskLoader, Inspection, inspect};
use rpi_image::Scalar;
use rpi_prims::{PrimId, registry};
use rpi_sema::query::{builtin, spatial_parts};
use rpi_syntax::{KEYWORDS, SourceToken, SourceTokenKind, source_tokens};
use rpi_testkit::files_below;

fn seen(path: &Path) -> Inspection {
    let text = std::fs::read_to_string(path).unwrap();
    inspect(path, &text, &DiskLoader)
}

/// Returns correct programs.
fn right() -> Vec<PathBuf> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/names/everything.rpi");
    let folders = ["examples", "stdlib"].map(|folder| files_below(folder, &[".rpi", ".lus"]));
    folders.concat().into_iter().chain([own]).collect()
}

#[test]
fn every_name_of_a_right_program_is_explained() {
    for path in right() {
        let seen = seen(&path);
        assert_eq!(seen.diagnostics, [], "{}", path.display());
        let unknown = unexplained(&seen);
        assert_eq!(unknown, Vec::<String>::new(), "{}", path.display());
    }
}

#[test]
fn references_are_places_of_the_name() {
    for path in right() {
        let seen = seen(&path);
        for (id, def) in seen.index().defs_in(FileId(0)) {
            for span in seen.index().references(id) {
                // The title of a test is in quotes.
                let written = seen.sources.slice(span).trim_matches('"');
                let is_module = span.start == span.end;
                assert!(
                    is_module || written.ends_with(&*def.name),
                    "{written} is not {}",
                    def.name
                );
            }
        }
    }
}

/// Returns the names in the main text that have no explanation, with their lines.
fn unexplained(seen: &Inspection) -> Vec<String> {
    let text = seen.sources.text(FileId(0));
    let known = without_declaration();
    let all = source_tokens(text, seen.mode());
    let words: Vec<&SourceToken> = all
        .iter()
        .filter(|p| !matches!(p.kind, SourceTokenKind::Comment(_)))
        .collect();
    let word = |k: usize| words.get(k).map_or("", |piece| &text[piece.range.clone()]);
    let mut unknown = Vec::new();
    for (k, piece) in words.iter().enumerate() {
        let name = word(k);
        let offset = u32::try_from(piece.range.start).unwrap();
        // `tool in base`, or `arm.tool in arm.base` with the frames of a device.
        let is_frame = word(k + 1) == "in"
            || k > 0 && word(k - 1) == "in"
            || k > 2 && word(k - 1) == "." && word(k - 3) == "in"
            // `Vector<<real[m]>>(base)`, `Vector(arm.base)`
            || k > 1 && [">>", "Vector"].contains(&word(k - 2)) && word(k - 1) == "(" && word(k + 1) == ")"
            || k > 3 && [">>", "Vector"].contains(&word(k - 4)) && word(k - 3) == "(" && word(k + 1) == ")";
        let explained = piece.kind != SourceTokenKind::Name
            || seen
                .index()
                .reference_at(FileId(0), offset)
                .is_some_and(|r| r.span.start == offset)
            || known.contains(name)
            || builtin(name).is_some()
            || PrimId::from_name(name).is_some()
            // `on any then end`: keywords that are names elsewhere.
            || name == "any"
            || KEYWORDS.iter().any(|word| word.text == name)
            || is_unit(&words[..k], text)
            || is_frame;
        if !explained {
            let line = text[..piece.range.start].matches('\n').count() + 1;
            unknown.push(format!("{name} in line {line}"));
        }
    }
    unknown
}

/// Returns the names of ports and parameters of primitives, and of types and components of spatial values.
fn without_declaration() -> BTreeSet<String> {
    let ports = registry().iter().flat_map(|prim| {
        let inputs = prim.desc.inputs.iter().map(|port| port.name.to_owned());
        let outputs = prim.desc.outputs.iter().map(|port| port.name.to_owned());
        let params = prim.desc.params.iter().map(|param| param.name.to_owned());
        inputs.chain(outputs).chain(params)
    });
    let spatial = [
        Scalar::Vector,
        Scalar::Rotation,
        Scalar::Pose,
        Scalar::Twist,
        Scalar::Wrench,
    ];
    let parts = spatial
        .iter()
        .flat_map(|scalar| spatial_parts(*scalar).map(str::to_owned));
    let types = spatial.iter().map(Scalar::to_string);
    ports.chain(parts).chain(types).collect()
}

/// Returns whether the token after these is in the unit brackets after a number or `real`.
fn is_unit(words: &[&SourceToken], text: &str) -> bool {
    let written = |piece: &&&SourceToken| &text[piece.range.clone()];
    let mut before = words.iter().rev();
    let inside = |p: &&&SourceToken| {
        matches!(p.kind, SourceTokenKind::Name | SourceTokenKind::Number)
            || ["/", "*", "^"].contains(&written(p))
    };
    let open = before.by_ref().find(|piece| !inside(piece));
    let of = before.next();
    let measured = of.is_some_and(|p| p.kind == SourceTokenKind::Number || written(&p) == "real");
    open.is_some_and(|p| written(&p) == "[") && measured
}
