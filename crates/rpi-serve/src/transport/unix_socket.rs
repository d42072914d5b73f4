//! Creation of a Unix socket.

use std::fs;
use std::io::{self, ErrorKind};
use std::os::unix::fs::{FileTypeExt, PermissionsExt};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::Path;

/// Binds a listener to the socket file at `path`. The file of a server that has ended is replaced; any other file is
/// not touched. `mode` sets the permissions of the socket file.
///
/// # Errors
/// If another file or a live server is at the path, or a system call fails. The text names the path.
pub(crate) fn bind(path: &Path, mode: Option<u32>) -> io::Result<UnixListener> {
    let bound = match UnixListener::bind(path) {
        Err(why) if why.kind() == ErrorKind::AddrInUse && is_stale(path) => {
            fs::remove_file(path).and_then(|()| UnixListener::bind(path))
        }
        bound => bound,
    };
    let bound = bound.map_err(|why| {
        let is_taken = why.kind() == ErrorKind::AddrInUse;
        let helps = match is_socket(path) {
            true if is_taken => "; another server is listening there",
            false if is_taken => "; another file is at this path and is kept",
            _ => "",
        };
        io::Error::new(why.kind(), format!("{}: {why}{helps}", path.display()))
    })?;
    bound.set_nonblocking(true)?;
    if let Some(mode) = mode {
        fs::set_permissions(path, fs::Permissions::from_mode(mode & 0o777))?;
        // A client that connected earlier had the permissions of a new file.
        while bound.accept().is_ok() {}
    }
    Ok(bound)
}

/// Returns whether a socket file is at the path at which no server listens any more.
fn is_stale(path: &Path) -> bool {
    let refused = |why: io::Error| why.kind() == ErrorKind::ConnectionRefused;
    is_socket(path) && UnixStream::connect(path).err().is_some_and(refused)
}

fn is_socket(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|meta| meta.file_type().is_socket())
}
