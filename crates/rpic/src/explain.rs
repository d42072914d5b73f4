//! `rpic explain`: prints the explanation page of a diagnostic code, or the list of all codes.

use rpi_diag::{Code, suggest};

use crate::outcome::{CommandResult, Exit, write_output};

/// Carries out `rpic explain CODE`: prints the explanation page of a diagnostic code. `name` is the code with or
/// without the prefix `RPI`.
pub(crate) fn explain(name: &str) -> CommandResult {
    let upper = match name.bytes().all(|byte| byte.is_ascii_digit()) {
        true => format!("RPI{name:0>4}"),
        false => name.to_uppercase(),
    };
    let Some(code) = Code::parse(&upper) else {
        let near = suggest(&upper, Code::ALL.iter().map(|code| code.as_str()));
        let near = near.map_or(String::new(), |code| format!("; did you mean {code}?"));
        return Err(format!("unknown diagnostic code: {name}{near}").into());
    };
    write_output(None, code.page().as_bytes())?;
    Ok(Exit::Success)
}

/// Carries out `rpic explain --list`: prints all diagnostic codes with their titles.
pub(crate) fn list() -> CommandResult {
    let lines = Code::ALL
        .iter()
        .map(|code| format!("{}  {}\n", code.as_str(), code.title()));
    write_output(None, lines.collect::<String>().as_bytes())?;
    Ok(Exit::Success)
}
