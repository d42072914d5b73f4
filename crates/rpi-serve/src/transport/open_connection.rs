//! Streams as the table of connections sees them.

use std::net::{Shutdown, TcpStream};
use std::os::fd::AsFd;
use std::os::unix::net::UnixStream;

use rustix::net::{RecvFlags, recv};

use super::places::OpenConnection;

impl OpenConnection for TcpStream {
    fn close(&self) {
        // The client may have closed the connection meanwhile.
        let _ = self.shutdown(Shutdown::Both);
    }

    fn has_unread_data(&self) -> bool {
        has_unread_data(self)
    }
}

impl OpenConnection for UnixStream {
    fn close(&self) {
        let _ = self.shutdown(Shutdown::Both);
    }

    fn has_unread_data(&self) -> bool {
        has_unread_data(self)
    }
}

/// Returns whether a socket has data that can be read now. The data stays unread, and the socket blocks as before.
fn has_unread_data(socket: impl AsFd) -> bool {
    let flags = RecvFlags::PEEK | RecvFlags::DONTWAIT;
    recv(socket, &mut [0u8; 1][..], flags).is_ok_and(|(read, _)| read > 0)
}
