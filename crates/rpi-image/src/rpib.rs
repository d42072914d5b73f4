//! Binary file format of an image, `.rpib`: magic number, format version, checksum, content.
//!
//! The code does not use a serialisation crate: the format is the one table below, the crate needs no dependency for
//! it, and a length read from a file cannot make the reader allocate more than the size of the file allows.

use crate::desc::{CommandFlow, DeviceResponse};
use crate::encoding::{Encoding, ReadError, Reader};
use crate::external::{ExternalFunction, ExternalPort};
use crate::hash::Fnv1a;
use crate::image::{
    ActuatorPort, CommandEnd, CommandEndKind, CoreFlow, DebugInfo, DeviceFunction, DevicePort,
    Export, Form, Fragment, Image, InputPort, Layout, NamedResult, PrimUse, Probe, SensorPort,
    Signal, SlotRange, SourceLocation, Step, TextRange,
};
use crate::types::{Scalar, Type};
use crate::{encode_enum, encode_struct};
use alloc::string::String;
use alloc::vec::Vec;

const MAGIC: [u8; 4] = *b"RPIB";
/// Version of the `.rpib` format. Any change of a table in this file needs a new version.
pub const VERSION: u16 = 5;
/// Length of the header of a file in bytes: magic number, version and checksum.
const HEADER_LEN: usize = MAGIC.len() + size_of::<u16>() + size_of::<u64>();

/// Computes the checksum of the content of an image file and writes it to the header of `file`, for tests and tools
/// that modify files. Does nothing if the file is shorter than a header.
pub fn update_checksum(file: &mut [u8]) {
    if let Some((header, content)) = file.split_at_mut_checked(HEADER_LEN) {
        let checksum = Fnv1a::new().with_bytes(content).finish();
        header[MAGIC.len() + size_of::<u16>()..].copy_from_slice(&checksum.to_le_bytes());
    }
}

impl Image {
    /// Returns the image in the binary form of a `.rpib` file.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut content = Vec::new();
        self.encode(&mut content);
        let mut bytes = Vec::with_capacity(HEADER_LEN + content.len());
        bytes.extend_from_slice(&MAGIC);
        VERSION.encode(&mut bytes);
        Fnv1a::new()
            .with_bytes(&content)
            .finish()
            .encode(&mut bytes);
        bytes.append(&mut content);
        bytes
    }

    /// Reads an image from the bytes of a `.rpib` file. The image is not verified: see [`crate::verify()`].
    ///
    /// # Errors
    /// Returns an error with the position in the file if the bytes are not a complete image of this version.
    pub fn from_bytes(bytes: &[u8]) -> Result<Image, ReadError> {
        let rest = bytes.strip_prefix(&MAGIC).ok_or(ReadError::NotAnImage)?;
        let mut header = Reader::new(rest);
        let version = u16::decode(&mut header)?;
        // The version comes before the checksum, so that a file of another version is not reported as damaged.
        if version != VERSION {
            return Err(ReadError::UnsupportedVersion(version));
        }
        let checksum = u64::decode(&mut header)?;
        let content = bytes.get(HEADER_LEN..).unwrap_or(&[]);
        if Fnv1a::new().with_bytes(content).finish() != checksum {
            return Err(ReadError::ChecksumMismatch);
        }
        let mut content = Reader::new(content);
        let image = Image::decode(&mut content)?;
        content.expect_end()?;
        Ok(image)
    }
}

encode_struct!(Image {
    name: String,
    period_ns: u64,
    tick_ns: u64,
    layout: Layout,
    init: Vec<(u32, u64)>,
    prims_used: Vec<PrimUse>,
    code: Vec<u32>,
    steps: Vec<Step>,
    commit: Vec<Step>,
    fragments: Vec<Fragment>,
    sensors: Vec<SensorPort>,
    actuators: Vec<ActuatorPort>,
    functions: Vec<DeviceFunction>,
    inputs: Vec<InputPort>,
    exports: Vec<Export>,
    flows: Vec<CoreFlow>,
    end: CommandEnd,
    debug: DebugInfo,
});
encode_struct!(DebugInfo {
    locations: Vec<SourceLocation>,
    origins: Vec<(u32, u32)>,
    probes: Vec<Probe>,
    step_locations: Vec<u32>,
});

encode_struct!(Layout {
    constants: u32,
    external: u32,
    state: u32,
    end: u32
});
encode_struct!(PrimUse {
    name: String,
    signature: u64
});
encode_struct!(SlotRange {
    start: u32,
    len: u32
});
encode_struct!(Signal {
    start: u32,
    present: u32,
    ty: Type
});
encode_struct!(Fragment { path: String, parent: Option<u32>, active: u32, state: SlotRange });
encode_struct!(DevicePort {
    device: String,
    port: String,
    index: u32,
    ty: Type
});
encode_struct!(SensorPort {
    port: DevicePort,
    value: Signal
});
encode_struct!(ActuatorPort { port: DevicePort, inputs: Vec<SlotRange>, responses: Vec<(DeviceResponse, u32)> });
encode_struct!(DeviceFunction { port: DevicePort, arguments: Vec<SlotRange>, results: Vec<SlotRange>, present: u32, work: u32, external: Option<ExternalFunction> });
encode_struct!(ExternalFunction { symbol: String, name: String, inputs: Vec<ExternalPort>, outputs: Vec<ExternalPort> });
encode_struct!(ExternalPort {
    name: String,
    kind: Scalar,
    len: u32,
    is_array: bool,
    ty: String
});
encode_struct!(InputPort { key: String, unit: String, value: Signal, last_updated: Option<Signal> });
encode_struct!(Export {
    key: String,
    unit: String,
    value: Signal
});
encode_struct!(CoreFlow {
    kind: CommandFlow,
    value: Signal
});
encode_struct!(NamedResult {
    name: String,
    kind: CommandEndKind,
    condition: Signal
});
encode_struct!(SourceLocation { path: String, flow: Option<String>, range: Option<TextRange> });
encode_struct!(TextRange {
    file: u32,
    start: u32,
    end: u32
});
encode_struct!(Probe {
    location: u32,
    port: String,
    value: Signal,
    fragment: u32
});

encode_enum!(Step {
    0 = Run { prim, form, start, len },
    1 = Copy { at, len },
    2 = Skip { unless, target },
    3 = Reset { unless, fragment },
    4 = Actuate { actuator },
    5 = Call { function },
});
encode_enum!(Form { 0 = Total, 1 = Optional });
encode_enum!(CommandEnd { 0 = Results(results), 1 = Ports { terminate, fail } });
encode_enum!(CommandEndKind { 0 = Finish, 1 = Yield, 2 = Fail });
encode_enum!(DeviceResponse { 0 = ConcurrentAccess, 1 = DeviceFailed, 2 = IllegalValue, 3 = ErrorCode, 4 = Completed });
encode_enum!(CommandFlow {
    0 = Cancel,
    1 = Takeover,
    2 = Time,
    3 = Period,
    4 = NetTime,
    5 = WallTime,
    6 = Predecessor,
    7 = Elapsed,
    8 = PeriodTicks,
    9 = SpeedOverride,
    10 = Pause,
});
encode_enum!(Type { 0 = Scalar(scalar), 1 = Array(scalar, len), 2 = Matrix(rows, cols) });
encode_enum!(Scalar {
    0 = Bool,
    1 = Int,
    2 = Real,
    3 = Time,
    4 = Vector,
    5 = Rotation,
    6 = Pose,
    7 = Twist,
    8 = Wrench,
});
