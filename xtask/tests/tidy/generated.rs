//! Committed generated files must be equal to the output of their generators.

use xtask::generated;

#[test]
fn generated_files_are_current() {
    let all = generated();
    let stale: Vec<&str> = all
        .iter()
        .filter(|file| !file.is_current())
        .map(|file| file.path)
        .collect();
    assert!(
        stale.is_empty(),
        "run `cargo xtask gen` and review the changes in {stale:?}"
    );
}

#[test]
fn the_editor_grammar_colours_every_keyword() {
    let all = generated();
    let grammar = all
        .iter()
        .find(|file| file.path.ends_with("tmLanguage.json"))
        .expect("it is generated");
    for word in rpi_syntax::KEYWORDS {
        let listed = grammar
            .text
            .split(['|', ':', '(', ')'])
            .any(|part| part == word.text);
        assert!(listed, "{} is not in the grammar for editors", word.text);
    }
}

#[test]
fn the_files_of_the_editor_extension_are_json_and_lead_to_each_other() {
    let root = rpi_testkit::workspace_root().join("editor-support/vscode");
    let read = |name: &str| -> serde_json::Value {
        let text = std::fs::read_to_string(root.join(name)).unwrap_or_default();
        serde_json::from_str(&text).unwrap_or_else(|error| panic!("{name}: {error}"))
    };
    let contributes = &read("package.json")["contributes"];
    let configuration = contributes["languages"][0]["configuration"]
        .as_str()
        .unwrap_or("");
    assert!(read(configuration)["comments"]["lineComment"] == "--");
    let grammar = contributes["grammars"][0]["path"].as_str().unwrap_or("");
    assert_eq!(
        read(grammar)["scopeName"],
        contributes["grammars"][0]["scopeName"]
    );
}
