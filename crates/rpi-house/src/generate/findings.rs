//! The chapter on findings: every code with its page.

use rpi_diag::Code;

use super::MARK;

pub(super) fn chapter() -> String {
    let mut out = format!("{MARK}# Findings\n\nWhat the tools say of a program, by code. ");
    out.push_str("`rpic explain CODE` prints the same page.\n\n| code | | |\n|---|---|---|\n");
    for code in Code::ALL {
        out.push_str(&format!(
            "| `{code}` | {} | {} |\n",
            code.severity().as_str(),
            code.title()
        ));
    }
    for code in Code::ALL {
        // The page's own heading becomes a section of the chapter.
        out.push_str(&format!("\n#{}", code.page()));
    }
    out
}
