//! Tokens of clients, each with a name and a role, and the file that has them.

use std::fmt;
use std::fs::{File, Metadata};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::role::Role;

/// Secret token by which the server authenticates a client, with the client's name and role.
#[derive(Clone, PartialEq, Eq)]
pub struct ClientToken {
    /// Name of the client, as it appears in the log.
    pub name: Arc<str>,
    /// Role of the client, which determines the requests that the server accepts from the client.
    pub role: Role,
    /// Secret text of the token: 16 to 4096 printable ASCII characters without blanks.
    pub secret: String,
}

impl ClientToken {
    /// Creates a token for a client with this name and role.
    #[must_use]
    pub fn new(name: &str, role: Role, secret: &str) -> ClientToken {
        ClientToken {
            name: name.into(),
            role,
            secret: secret.to_owned(),
        }
    }
}

/// Debug output with the client's name and role, but without the secret, which must not get into a log.
impl fmt::Debug for ClientToken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ClientToken({}, {})", self.name, self.role)
    }
}

/// Error: a file with secrets (client tokens or a private key) cannot be used.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SecretFileError {
    /// Path of the file with secrets.
    pub path: PathBuf,
    /// Number of the line with the error, from 1; `None` if the error concerns the whole file.
    pub line: Option<usize>,
    /// Description of the error, for the user.
    pub reason: String,
}

impl fmt::Display for SecretFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        write!(f, ": {}", self.reason)
    }
}

impl std::error::Error for SecretFileError {}

/// Maximum size of a file with tokens in bytes.
const MAX_FILE_BYTES: u64 = 1 << 20;
/// Minimum and maximum length of a token in bytes. The maximum is below the 16 KiB that an HTTP request head may have.
const TOKEN_BYTES: std::ops::RangeInclusive<usize> = 16..=4096;
/// Name of the client whose token stands alone in the token file, without name and role.
const ONLY_CLIENT: &str = "client";
/// Shell command that generates a random token; error messages about token files suggest it.
const MAKE_TOKEN: &str = "`head -c 32 /dev/urandom | base64`";

/// Reads the tokens of clients: one line `NAME ROLE TOKEN` for each, or a single token alone, which has the role
/// `programmer`. Empty lines and lines that begin with `#` are ignored.
///
/// # Errors
/// If the file cannot be read, other users may read it, or a line is malformed.
pub fn read_tokens(path: &Path) -> Result<Vec<ClientToken>, SecretFileError> {
    let text = read_secret(path)?;
    parse_tokens(&text).map_err(|(line, reason)| SecretFileError {
        path: path.to_owned(),
        line,
        reason,
    })
}

/// Reads a text file of at most [`MAX_FILE_BYTES`] and returns its text. Returns an error if users other than the owner
/// of the file may read or write it.
fn read_secret(path: &Path) -> Result<String, SecretFileError> {
    let error = |reason: String| SecretFileError {
        path: path.to_owned(),
        line: None,
        reason,
    };
    let io = |why: io::Error| error(why.to_string());
    let file = File::open(path).map_err(io)?;
    ensure_private(&file.metadata().map_err(io)?).map_err(error)?;
    let mut text = String::new();
    file.take(MAX_FILE_BYTES + 1)
        .read_to_string(&mut text)
        .map_err(io)?;
    match text.len() as u64 > MAX_FILE_BYTES {
        true => Err(error(format!(
            "the file has more than {MAX_FILE_BYTES} bytes"
        ))),
        false => Ok(text),
    }
}

/// Returns an error if others than the owner may read or write a file with a secret.
///
/// # Errors
/// The text has the permissions of the file and the command that corrects them.
#[cfg(feature = "tls")]
pub(crate) fn ensure_private_file(path: &Path) -> Result<(), String> {
    let meta = path.metadata().map_err(|why| why.to_string())?;
    ensure_private(&meta)
}

#[cfg(unix)]
fn ensure_private(meta: &Metadata) -> Result<(), String> {
    use std::os::unix::fs::PermissionsExt;
    let mode = meta.permissions().mode() & 0o777;
    match mode & 0o077 {
        0 => Ok(()),
        _ => Err(format!(
            "other users can use this secret (permissions {mode:03o}); make it private with `chmod 600` and replace what they may have read"
        )),
    }
}

#[cfg(not(unix))]
fn ensure_private(_: &Metadata) -> Result<(), String> {
    Ok(())
}

/// Error in the text of a token file: number of the line from 1 (`None` for the whole file), and description of the
/// error.
type TokenError = (Option<usize>, String);

fn parse_tokens(text: &str) -> Result<Vec<ClientToken>, TokenError> {
    let lines = text
        .lines()
        .enumerate()
        .map(|(k, line)| (k + 1, line.trim()));
    let lines: Vec<(usize, &str)> = lines
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
        .collect();
    let mut tokens: Vec<ClientToken> = Vec::new();
    for (number, line) in &lines {
        let token = parse_line(line, lines.len() == 1).map_err(|why| (Some(*number), why))?;
        if let Some(why) = tokens.iter().find_map(|other| clash(other, &token)) {
            return Err((Some(*number), why));
        }
        tokens.push(token);
    }
    match tokens.is_empty() {
        true => Err((
            None,
            format!("the file has no token; make one with {MAKE_TOKEN}"),
        )),
        false => Ok(tokens),
    }
}

fn parse_line(line: &str, is_only: bool) -> Result<ClientToken, String> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let (name, role, secret) = match words[..] {
        [secret] if is_only => (ONLY_CLIENT, Role::Programmer, secret),
        [name, role, secret] => (name, parse_role(role)?, secret),
        _ if is_only => {
            return Err("a token must be a single word; or write NAME ROLE TOKEN".to_owned());
        }
        _ => {
            return Err(format!(
                "expected NAME ROLE TOKEN, found {} words",
                words.len()
            ));
        }
    };
    if !TOKEN_BYTES.contains(&secret.len()) {
        let (least, most) = (TOKEN_BYTES.start(), TOKEN_BYTES.end());
        let length = rpi_diag::with_noun(secret.len(), "byte");
        return Err(format!(
            "a token of {length} is too {}; it must have {least} to {most}, for example of {MAKE_TOKEN}",
            if secret.len() < *least {
                "short"
            } else {
                "long"
            }
        ));
    }
    match secret.bytes().all(|byte| byte.is_ascii_graphic()) {
        true => Ok(ClientToken::new(name, role, secret)),
        false => Err("a token must have printable ASCII characters only".to_owned()),
    }
}

fn parse_role(name: &str) -> Result<Role, String> {
    let known = Role::ALL.map(|(name, _)| name);
    let meant = rpi_diag::suggest(name, known.into_iter());
    let meant = meant.map_or_else(String::new, |role| format!("; did you mean {role}?"));
    Role::from_name(name).ok_or_else(|| {
        format!(
            "there is no role {name}, expected one of {}{meant}",
            known.join(", ")
        )
    })
}

/// Returns the reason why two tokens cannot be in the same file (same name or same secret); `None` if they can.
fn clash(one: &ClientToken, other: &ClientToken) -> Option<String> {
    if one.name == other.name {
        return Some(format!("a second token has the name {}", one.name));
    }
    (one.secret == other.secret).then(|| format!("{} has the same token", one.name))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    const LONG: &str = "0123456789abcdef";

    #[test]
    fn a_file_has_one_token_or_lines_with_names_and_roles() {
        let single = parse_tokens(&format!("{LONG}\n")).unwrap();
        assert_eq!(single, [ClientToken::new("client", Role::Programmer, LONG)]);
        let text = format!("# cell 4\n\npanel viewer {LONG}1\nanna  operator\t{LONG}2\n");
        let tokens = parse_tokens(&text).unwrap();
        let expected = [
            ClientToken::new("panel", Role::Viewer, &format!("{LONG}1")),
            ClientToken::new("anna", Role::Operator, &format!("{LONG}2")),
        ];
        assert_eq!(tokens, expected);
        assert!(!format!("{tokens:?}").contains(LONG), "the secret is shown");
    }

    #[test]
    fn errors_name_the_line_and_what_is_expected() {
        for (text, line, reason) in [
            (String::new(), None, "has no token"),
            (
                "short".to_owned(),
                Some(1),
                "a token of 5 bytes is too short",
            ),
            (format!("a vewer {LONG}"), Some(1), "did you mean viewer?"),
            (
                format!("\na viewer {LONG}\n{LONG}"),
                Some(3),
                "expected NAME ROLE TOKEN, found 1",
            ),
            (
                format!("a viewer {LONG}\na admin {LONG}1"),
                Some(2),
                "the name a",
            ),
            (
                format!("a viewer {LONG}\nb admin {LONG}"),
                Some(2),
                "the same token",
            ),
            (format!("{LONG}ä"), Some(1), "ASCII"),
            (format!("open {LONG}"), Some(1), "a single word"),
        ] {
            let (at, why) = parse_tokens(&text).unwrap_err();
            assert_eq!(at, line, "{text}");
            assert!(why.contains(reason), "{why}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_file_that_others_may_read_is_refused() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tokens");
        fs::write(&path, LONG).unwrap();
        for (mode, is_private) in [
            (0o600, true),
            (0o400, true),
            (0o640, false),
            (0o604, false),
            (0o620, false),
        ] {
            fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
            let read = read_tokens(&path);
            assert_eq!(read.is_ok(), is_private, "{mode:o}: {read:?}");
        }
    }
}
