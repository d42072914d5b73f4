//! One TCP connection by RTDE: the requests that set it up, and the exchange of packages.

use super::UrSpec;
use super::error::RtdeError;
use super::package::{PackageBuffer, encode, kind};
use super::recipe::{Command, INPUTS, OUTPUTS, Sample, check_answer, names};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use std::io::{self, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

/// Version of the protocol that the driver uses. Version 2 has output recipes with a frequency.
const VERSION: u16 = 2;
/// Time in which the controller must accept a connection and answer each request.
const ANSWER_TIME: Duration = Duration::from_secs(2);
/// First major version of the controllers with cycles of 2 ms (e-Series); older ones have cycles of 8 ms.
const FIRST_FAST_VERSION: u32 = 5;

/// Connection by RTDE that exchanges samples and commands.
pub(super) struct Session {
    stream: TcpStream,
    buffer: PackageBuffer,
    output_recipe: u8,
    input_recipe: u8,
    /// Duration of a cycle of the controller, in s.
    pub(super) cycle: f64,
}

/// Opens a TCP connection to a port of the controller.
///
/// # Errors
/// Returns the error of the system, with the address.
pub(super) fn connect(host: &str, port: u16) -> io::Result<TcpStream> {
    let refused = |error: io::Error| {
        io::Error::new(
            error.kind(),
            format!("cannot connect to {host}:{port}: {error}"),
        )
    };
    let mut last = io::Error::new(io::ErrorKind::NotFound, "the name has no address");
    for address in (host, port).to_socket_addrs().map_err(refused)? {
        match TcpStream::connect_timeout(&address, ANSWER_TIME) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                stream.set_write_timeout(Some(ANSWER_TIME))?;
                return Ok(stream);
            }
            Err(error) => last = error,
        }
    }
    Err(refused(last))
}

impl Session {
    /// Connects, sets up both recipes and starts the exchange.
    ///
    /// # Errors
    /// Returns the error of the connection, or the request that the controller rejects.
    pub(super) fn open(spec: &UrSpec) -> Result<Self, RtdeError> {
        let stream = connect(&spec.host, spec.rtde_port)?;
        let mut session = Self {
            stream,
            buffer: PackageBuffer::new(),
            output_recipe: 0,
            input_recipe: 0,
            cycle: 0.002,
        };
        session.set_up()?;
        Ok(session)
    }

    fn set_up(&mut self) -> Result<(), RtdeError> {
        let request = kind::PROTOCOL_VERSION;
        let answer = self.request(request, &VERSION.to_be_bytes(), "version 2 of RTDE")?;
        if answer != [1] {
            return Err(RtdeError::ProtocolVersion);
        }
        let request = kind::CONTROLLER_VERSION;
        let answer = self.request(request, &[], "the version of the controller")?;
        let (major, _) = answer
            .split_first_chunk()
            .ok_or(RtdeError::MalformedPackage(request))?;
        let frequency = match u32::from_be_bytes(*major) >= FIRST_FAST_VERSION {
            true => 500.0_f64,
            false => 125.0,
        };
        self.cycle = 1.0 / frequency;
        let mut payload = frequency.to_be_bytes().to_vec();
        payload.extend(names(OUTPUTS).bytes());
        let answer = self.request(kind::SETUP_OUTPUTS, &payload, "the outputs")?;
        self.output_recipe = check_answer(OUTPUTS, &answer, kind::SETUP_OUTPUTS)?;
        let answer = self.request(kind::SETUP_INPUTS, names(INPUTS).as_bytes(), "the inputs")?;
        self.input_recipe = check_answer(INPUTS, &answer, kind::SETUP_INPUTS)?;
        match self.request(kind::START, &[], "the start")?.as_slice() {
            [1] => Ok(()),
            _ => Err(RtdeError::RequestRejected("the start of the exchange")),
        }
    }

    /// Sends a request and returns the payload of the answer, which has the same kind. Other packages, such as messages
    /// for people, are skipped. `what` names the request in errors.
    fn request(
        &mut self,
        kind: u8,
        payload: &[u8],
        what: &'static str,
    ) -> Result<Vec<u8>, RtdeError> {
        self.stream.write_all(&encode(kind, payload))?;
        let deadline = Instant::now() + ANSWER_TIME;
        while Instant::now() < deadline {
            while let Some(package) = self.buffer.next()? {
                if package.kind == kind {
                    return Ok(package.payload.to_vec());
                }
            }
            if !self.fill(deadline)? {
                break;
            }
        }
        Err(RtdeError::NoAnswer(what))
    }

    /// Reads bytes from the connection. Returns false if none come before `deadline`.
    ///
    /// Waits with the resolution of the clock: the read timeout of a socket is rounded up to 1/HZ s, which is 10 ms on some
    /// systems.
    fn fill(&mut self, deadline: Instant) -> Result<bool, RtdeError> {
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            let timeout = Timespec::try_from(left).ok();
            let mut ready = [PollFd::new(&self.stream, PollFlags::IN)];
            match poll(&mut ready, timeout.as_ref()) {
                Ok(0) => return Ok(false),
                Ok(_) => {}
                Err(Errno::INTR) => continue,
                Err(error) => return Err(io::Error::from(error).into()),
            }
            match self.stream.read(self.buffer.space()) {
                Ok(0) => return Err(RtdeError::Closed),
                Ok(count) => {
                    self.buffer.add(count);
                    return Ok(true);
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error.into()),
            }
        }
    }

    /// Returns the newest sample that has come; `None` if none has.
    fn newest(&mut self) -> Result<Option<Sample>, RtdeError> {
        let mut newest = None;
        while let Some(package) = self.buffer.next()? {
            if package.kind == kind::DATA {
                let sample = Sample::decode(self.output_recipe, package.payload);
                newest = Some(sample.ok_or(RtdeError::MalformedPackage(kind::DATA))?);
            }
        }
        Ok(newest)
    }

    /// Waits for the next sample until `deadline`, and returns it; `None` if none came. Messages and parts of packages do
    /// not end the wait. If several samples have come, returns the newest.
    ///
    /// # Errors
    /// Returns the error of the connection, and an error for a data package that does not fit the recipe.
    pub(super) fn receive(&mut self, deadline: Instant) -> Result<Option<Sample>, RtdeError> {
        loop {
            if !self.fill(deadline)? {
                return Ok(None);
            }
            if let Some(sample) = self.newest()? {
                return Ok(Some(sample));
            }
        }
    }

    /// Sends a command to the program in the controller.
    ///
    /// # Errors
    /// Returns the error of the connection.
    pub(super) fn send(&mut self, command: &Command) -> Result<(), RtdeError> {
        let package = encode(kind::DATA, &command.encode(self.input_recipe));
        Ok(self.stream.write_all(&package)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::TcpListener;
    use std::thread;

    /// Opens a session with a server that sends these bytes and closes the connection.
    fn open(answer: &'static [u8]) -> RtdeError {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = listener.local_addr().expect("bound").port();
        let server = thread::spawn(move || {
            let (mut stream, _) = listener.accept().expect("a client");
            let mut request = [0; 5];
            stream.read_exact(&mut request).expect("a request");
            assert_eq!(request, [0, 5, b'V', 0, 2]);
            stream.write_all(answer).expect("sent");
        });
        let spec = UrSpec {
            host: "127.0.0.1".to_owned(),
            rtde_port: port,
            script_port: 1,
            timeout: 0.1,
            lookahead: 0.1,
            gain: 300.0,
        };
        let error = Session::open(&spec).err().expect("an error");
        server.join().expect("the server");
        error
    }

    #[test]
    fn servers_of_other_protocols_and_versions_are_reported() {
        let message = |answer| open(answer).to_string();
        assert!(message(b"HTTP/1.1 400 Bad Request").contains("is this the RTDE port?"));
        assert!(message(b"\xff\xffV").contains("65535 bytes"));
        assert!(message(b"\0\x04V\0").contains("does not support RTDE version 2"));
        assert!(matches!(open(b""), RtdeError::Closed));
    }
}
