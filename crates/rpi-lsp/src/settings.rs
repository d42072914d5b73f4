//! Settings of the user: options of `initialize`, and `workspace/didChangeConfiguration`.

use serde_json::Value;

/// Section of the configuration of an editor that holds the settings.
pub(crate) const SECTION: &str = "rpi";

/// Settings that the editor sends. A missing setting has its default.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Settings {
    /// Whether inlay hints are shown (`inlayHints`, default true).
    pub(crate) inlay_hints: bool,
    /// Whether code lenses are shown (`codeLens`, default true).
    pub(crate) code_lenses: bool,
    /// Whether the client requests diagnostics instead of receiving them (`pullDiagnostics`, default false). Only the
    /// options of `initialize` decide it.
    pub(crate) pull_diagnostics: bool,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            inlay_hints: true,
            code_lenses: true,
            pull_diagnostics: false,
        }
    }
}

impl Settings {
    /// Returns these settings with those that `options` contains, in an object `rpi` or at the top.
    pub(crate) fn with_options(self, options: &Value) -> Settings {
        let options = options.get(SECTION).unwrap_or(options);
        let flag =
            |name: &str, old: bool| options.get(name).and_then(Value::as_bool).unwrap_or(old);
        Settings {
            inlay_hints: flag("inlayHints", self.inlay_hints),
            code_lenses: flag("codeLens", self.code_lenses),
            pull_diagnostics: flag("pullDiagnostics", self.pull_diagnostics),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn settings_are_read_from_the_section_or_the_top() {
        let settings = Settings::default();
        let changed = settings.with_options(&json!({ "rpi": { "inlayHints": false } }));
        assert!(!changed.inlay_hints && changed.code_lenses);
        let changed = settings.with_options(&json!({ "codeLens": false, "inlayHints": 3 }));
        assert!(changed.inlay_hints && !changed.code_lenses);
        assert_eq!(settings.with_options(&Value::Null), settings);
    }
}
