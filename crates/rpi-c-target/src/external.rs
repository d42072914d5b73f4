//! External functions of a program in the core: a process that contains them, and a device bank that calls it.
//!
//! The functions run in a process of their own, because the workspace has no `unsafe` code, and because an error in them
//! must not end the tool. A call takes some ten microseconds, so that it is no substitute for C on a real-time thread.

use super::compiler::{CBinary, CCompiler, CTargetError};
use super::process::{error, line, word};
use rpi_codegen::{external_functions, external_host};
use rpi_device::{
    DeviceBank, Discontinuity, NoDevices, PortId, PortKind, PortQuery, Rejection, ResolveError,
};
use rpi_image::Image;
use rpi_image::external::EXTERNAL_DEVICE;
use std::cell::RefCell;
use std::io::{BufRead, BufReader, Write};
use std::ops::Range;
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Stdio};
use std::rc::Rc;

/// Number of the first port of an external function. Cells have fewer ports.
const FIRST_PORT: u32 = 1 << 31;

/// Process that computes the external functions of an image.
pub struct ExternalProcess {
    child: Child,
    requests: Option<ChildStdin>,
    replies: BufReader<ChildStdout>,
    /// Names of the functions in C, in the order of their numbers.
    symbols: Vec<String>,
    _binary: CBinary,
}

/// First error of the external functions of a run, shared with the device bank that calls them.
pub type ExternalError = Rc<RefCell<Option<CTargetError>>>;

impl ExternalProcess {
    /// Compiles a program that contains the functions of an image from `files` (C sources, object files or libraries),
    /// and starts it.
    ///
    /// # Errors
    /// Returns the messages of the compiler, for example that the files lack a function.
    pub fn start(
        image: &Image,
        files: &[PathBuf],
        compiler: &CCompiler,
    ) -> Result<ExternalProcess, CTargetError> {
        let paths = files.iter().map(|file| {
            let path = std::fs::canonicalize(file);
            path.map_err(|e| CTargetError(format!("{}: {e}", file.display())))
        });
        let paths: Vec<PathBuf> = paths.collect::<Result<_, _>>()?;
        // The process runs on this machine, whichever target the program has.
        let native = match compiler.is_microcontroller() {
            true => CCompiler::new(""),
            false => compiler.clone(),
        };
        let binary = native.link(&external_host(image), &paths)?;
        let mut command = binary.command();
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = command.spawn().map_err(error)?;
        let (requests, replies) = (child.stdin.take(), child.stdout.take());
        let replies = replies.ok_or_else(|| error("no pipe"))?;
        let symbols = external_functions(image).into_keys();
        Ok(ExternalProcess {
            child,
            requests,
            replies: BufReader::new(replies),
            symbols: symbols.map(str::to_owned).collect(),
            _binary: binary,
        })
    }

    fn call(&mut self, number: usize, arguments: &[u64]) -> Result<Vec<u64>, CTargetError> {
        let pipe = self.requests.as_mut().ok_or_else(|| error("no pipe"))?;
        let request = line(&number.to_string(), arguments);
        let sent = pipe.write_all(request.as_bytes());
        sent.and_then(|()| pipe.flush()).map_err(error)?;
        let mut reply = String::new();
        match self.replies.read_line(&mut reply).map_err(error)? {
            0 => Err(error("the process has ended")),
            _ => reply.split_whitespace().map(word).collect(),
        }
    }
}

impl Drop for ExternalProcess {
    fn drop(&mut self) {
        // The process ends at the end of its input.
        drop(self.requests.take());
        let _ = self.child.wait();
    }
}

/// Devices of a cell, and the external functions of a program.
pub struct ExternalBank<B> {
    devices: B,
    process: Option<ExternalProcess>,
    error: ExternalError,
}

impl<B: DeviceBank> ExternalBank<B> {
    /// Adds the functions of a process to the devices of a cell. Without a process, external functions are unknown.
    pub fn new(devices: B, process: Option<ExternalProcess>) -> ExternalBank<B> {
        ExternalBank {
            devices,
            process,
            error: ExternalError::default(),
        }
    }

    /// Returns the place of the first error of a call. After an error, results are not a number.
    #[must_use]
    pub fn error(&self) -> ExternalError {
        Rc::clone(&self.error)
    }
}

impl ExternalBank<NoDevices> {
    /// Creates a bank with the external functions of an image, without devices. `files` contain the functions: C sources,
    /// object files or libraries. Without files, external functions are unknown.
    ///
    /// # Errors
    /// Returns the messages of the compiler.
    pub fn without_devices(
        image: &Image,
        files: &[PathBuf],
        compiler: &CCompiler,
    ) -> Result<ExternalBank<NoDevices>, CTargetError> {
        let is_needed = !files.is_empty() && !external_functions(image).is_empty();
        let process = is_needed.then(|| ExternalProcess::start(image, files, compiler));
        Ok(ExternalBank::new(NoDevices, process.transpose()?))
    }
}

impl<B: DeviceBank> DeviceBank for ExternalBank<B> {
    fn resolve(&mut self, name: &PortQuery<'_>) -> Result<PortId, ResolveError> {
        let Some(process) = self
            .process
            .as_ref()
            .filter(|_| name.device == EXTERNAL_DEVICE)
        else {
            return self.devices.resolve(name);
        };
        let is_function = name.kind == PortKind::Function;
        let found = process.symbols.iter().position(|s| s == name.port);
        let found = found
            .filter(|_| is_function)
            .ok_or(ResolveError::UnknownPort)?;
        u32::try_from(found)
            .map(|k| PortId(FIRST_PORT + k))
            .map_err(|_| ResolveError::UnknownPort)
    }

    fn resource(&self, port: PortId) -> u32 {
        self.devices.resource(port)
    }

    fn resources(&self, port: PortId) -> Range<u32> {
        self.devices.resources(port)
    }

    fn begin_command(&mut self, resource: u32, ticks: u32) {
        self.devices.begin_command(resource, ticks);
    }

    fn read(&mut self, port: PortId, value: &mut [u64]) -> bool {
        self.devices.read(port, value)
    }

    fn check_set_point(&mut self, port: PortId, value: &[u64]) -> Rejection {
        self.devices.check_set_point(port, value)
    }

    fn discontinuity(&self, port: PortId, value: &[u64]) -> Option<Discontinuity> {
        self.devices.discontinuity(port, value)
    }

    fn error_code(&self, port: PortId) -> i64 {
        self.devices.error_code(port)
    }

    fn write(&mut self, port: PortId, value: &[u64]) {
        self.devices.write(port, value);
    }

    fn call(&mut self, port: PortId, arguments: &[u64], result: &mut [u64]) -> bool {
        let (Some(number), Some(process)) = (port.0.checked_sub(FIRST_PORT), &mut self.process)
        else {
            return self.devices.call(port, arguments, result);
        };
        let found = process.call(number as usize, arguments);
        let found = found.and_then(|words| match words.len() == result.len() {
            true => Ok(words),
            false => Err(error("unexpected reply")),
        });
        match found {
            Ok(words) => result.copy_from_slice(&words),
            Err(cause) => {
                let text = format!("the external functions have failed: {cause}");
                self.error.borrow_mut().get_or_insert(CTargetError(text));
                return false;
            }
        }
        true
    }

    fn is_moving(&self, resource: u32) -> bool {
        self.devices.is_moving(resource)
    }

    fn stop(&mut self, resource: u32) {
        self.devices.stop(resource);
    }

    fn make_safe(&mut self, resource: u32) {
        self.devices.make_safe(resource);
    }

    fn make_all_safe(&mut self) -> bool {
        self.devices.make_all_safe()
    }
}
