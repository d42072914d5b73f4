//! Value of `--socket`: `FILE[,role=ROLE][,mode=MODE]`.

use std::path::PathBuf;

use rpi_serve::{Role, SocketSettings};

/// Parses the value of `--socket`: the path of a Unix socket, followed by options. The path ends at the first `,role=`
/// or `,mode=` and may contain other commas. Returns a message for an invalid value.
pub(crate) fn parse_socket(text: &str) -> Result<SocketSettings, String> {
    let keys = [",role=", ",mode="].map(|key| text.find(key));
    let end = keys.into_iter().flatten().min().unwrap_or(text.len());
    let (path, options) = text.split_at(end);
    if path.is_empty() {
        return Err("expected FILE[,role=ROLE][,mode=MODE]".to_owned());
    }
    let mut socket = SocketSettings::new(PathBuf::from(path));
    for option in options.split(',').skip(1) {
        match option.split_once('=') {
            Some(("role", role)) => socket.role = parse_role(role)?,
            Some(("mode", mode)) => socket.mode = Some(parse_mode(mode)?),
            _ => {
                return Err(format!(
                    "unknown option {option}; expected role=ROLE or mode=MODE"
                ));
            }
        }
    }
    Ok(socket)
}

fn parse_role(name: &str) -> Result<Role, String> {
    Role::from_name(name).ok_or_else(|| {
        let known = Role::ALL.map(|(name, _)| name);
        format!(
            "there is no role {name}; expected one of {}",
            known.join(", ")
        )
    })
}

fn parse_mode(text: &str) -> Result<u32, String> {
    let mode = u32::from_str_radix(text, 8).ok();
    mode.filter(|mode| *mode <= 0o777)
        .ok_or_else(|| format!("mode {text}: expected an octal number up to 777, such as 660"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_socket_has_a_path_a_role_and_permissions() {
        let plain = parse_socket("a,b.sock").unwrap();
        assert_eq!(plain, SocketSettings::new(PathBuf::from("a,b.sock")));
        let full = parse_socket("rpi.sock,mode=660,role=operator").unwrap();
        assert_eq!((full.role, full.mode), (Role::Operator, Some(0o660)));
        for (text, reason) in [
            ("", "expected FILE"),
            (",role=viewer", "expected FILE"),
            ("x,role=king", "expected one of viewer, operator"),
            ("x,mode=888", "an octal number up to 777"),
            ("x,mode=1777", "an octal number up to 777"),
            ("x,role=viewer,rolle=x", "unknown option rolle=x"),
        ] {
            let why = parse_socket(text).unwrap_err();
            assert!(why.contains(reason), "{text}: {why}");
        }
    }
}
