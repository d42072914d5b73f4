//! Errors of the connection to a controller by RTDE.

use core::fmt;
use std::io;

/// Error of the connection to a controller by RTDE. The message states the way out.
#[derive(Debug)]
pub(super) enum RtdeError {
    /// Error of the operating system.
    Io(io::Error),
    /// The controller has closed the connection.
    Closed,
    /// The controller does not answer a request in time; the field names the request.
    NoAnswer(&'static str),
    /// A package has this size in bytes, which is less than its header or more than the driver accepts.
    PackageSize(usize),
    /// A package of this kind (ASCII code) has a wrong content.
    MalformedPackage(u8),
    /// The controller does not support version 2 of the protocol.
    ProtocolVersion,
    /// The controller does not know the variable with this name.
    UnknownVariable(&'static str),
    /// Another client of the controller writes the input with this name.
    VariableInUse(&'static str),
    /// A variable has another type than its description says.
    VariableType {
        /// Name of the variable.
        name: &'static str,
        /// Type that the controller states.
        found: String,
        /// Type of the published description.
        expected: &'static str,
    },
    /// The controller rejects the list of variables, or the start of the exchange; the field names the request.
    RequestRejected(&'static str),
}

impl fmt::Display for RtdeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => write!(f, "{error}"),
            Self::Closed => f.write_str("the controller has closed the connection"),
            Self::NoAnswer(request) => write!(
                f,
                "the controller does not answer the request for {request}; is this its RTDE port?"
            ),
            Self::PackageSize(size) => write!(
                f,
                "a package has an invalid size of {size} bytes; is this the RTDE port?"
            ),
            Self::MalformedPackage(kind) => {
                let kind = char::from(*kind).escape_default();
                write!(f, "a package of the kind `{kind}` has an invalid content")
            }
            Self::ProtocolVersion => f.write_str(
                "the controller does not support RTDE version 2; update its software to 3.9, 5.3 or later",
            ),
            Self::UnknownVariable(name) => write!(
                f,
                "the controller has no variable `{name}`; update its software to 3.9, 5.3 or later"
            ),
            Self::VariableInUse(name) => write!(
                f,
                "another client of the controller writes `{name}`; end that client, or free registers 24 to 29"
            ),
            Self::VariableType {
                name,
                found,
                expected,
            } => write!(f, "`{name}` has the type `{found}`, expected `{expected}`"),
            Self::RequestRejected(request) => {
                write!(f, "the controller rejects the request for {request}")
            }
        }
    }
}

impl std::error::Error for RtdeError {}

impl From<io::Error> for RtdeError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<RtdeError> for io::Error {
    fn from(error: RtdeError) -> Self {
        match error {
            RtdeError::Io(error) => error,
            other => Self::other(other),
        }
    }
}
