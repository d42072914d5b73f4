//! Generator of the chapter on diagnostics: every code with its explanation page.

use rpi_diag::Code;

use super::GENERATED_NOTICE;

pub(super) fn chapter() -> String {
    let mut out =
        format!("{GENERATED_NOTICE}# Diagnostics\n\nErrors, warnings and notes by code. ");
    out.push_str(
        "`rpic explain CODE` prints the same page.\n\n| code | severity | title |\n|---|---|---|\n",
    );
    for code in Code::ALL {
        out.push_str(&format!(
            "| `{code}` | {} | {} |\n",
            code.severity().as_str(),
            code.title()
        ));
    }
    for code in Code::ALL {
        // The heading of the page becomes a section of the chapter.
        out.push_str(&format!("\n#{}", code.page()));
    }
    out
}
