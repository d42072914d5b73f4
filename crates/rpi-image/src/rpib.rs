//! Binary file format of an image, `.rpib`: magic number, format version, checksum, content.
//!
//! The code does not use a serialisation crate: the format is the one table below, the crate needs no dependency for
//! it, and a length read from a file cannot make the reader allocate more than the size of the file allows.

use crate::desc::{Answer, CommandFlow};
use crate::hash::Fnv;
use crate::image::{
    Actuator, Cells, DevicePort, End, EndKind, EndResult, Export, Flow, Form, Fragment, Function,
    Image, InputPort, Layout, Place, PrimUse, Probe, Sensor, Signal, Step, TextRange,
};
use crate::ty::{Scalar, Type};
use crate::wire::{ReadError, Reader, Wire, wire_enum, wire_struct};
use alloc::string::String;
use alloc::vec::Vec;

const MAGIC: [u8; 4] = *b"RPIB";
/// Version of the format. Any change of a table below needs a new version.
pub const VERSION: u16 = 2;
/// Length of magic number, version and checksum, in bytes.
const HEADER: usize = MAGIC.len() + size_of::<u16>() + size_of::<u64>();

/// Updates the checksum in the header of `file`. Does nothing if the file is shorter than a header. For tests and tools
/// that modify files.
pub fn seal(file: &mut [u8]) {
    if let Some((header, content)) = file.split_at_mut_checked(HEADER) {
        let checksum = Fnv::new().bytes(content).finish();
        header[MAGIC.len() + size_of::<u16>()..].copy_from_slice(&checksum.to_le_bytes());
    }
}

impl Image {
    /// Returns the content of a `.rpib` file.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut content = Vec::new();
        self.put(&mut content);
        let mut bytes = Vec::with_capacity(HEADER + content.len());
        bytes.extend_from_slice(&MAGIC);
        VERSION.put(&mut bytes);
        Fnv::new().bytes(&content).finish().put(&mut bytes);
        bytes.append(&mut content);
        bytes
    }

    /// Reads a `.rpib` file. The image is not verified.
    ///
    /// # Errors
    /// Returns the reason and the position in the file.
    pub fn from_bytes(bytes: &[u8]) -> Result<Image, ReadError> {
        let rest = bytes.strip_prefix(&MAGIC).ok_or(ReadError::NotAnImage)?;
        let mut header = Reader::new(rest);
        let version = u16::get(&mut header)?;
        // The version comes before the checksum, so that a file of another version is not reported as damaged.
        if version != VERSION {
            return Err(ReadError::Version(version));
        }
        let checksum = u64::get(&mut header)?;
        let content = bytes.get(HEADER..).unwrap_or(&[]);
        if Fnv::new().bytes(content).finish() != checksum {
            return Err(ReadError::Checksum);
        }
        let mut content = Reader::new(content);
        let image = Image::get(&mut content)?;
        content.end()?;
        Ok(image)
    }
}

wire_struct!(Image {
    name: String,
    period_ns: u64,
    tick_ns: u64,
    layout: Layout,
    init: Vec<(u32, u64)>,
    prims: Vec<PrimUse>,
    code: Vec<u32>,
    steps: Vec<Step>,
    commit: Vec<Step>,
    fragments: Vec<Fragment>,
    sensors: Vec<Sensor>,
    actuators: Vec<Actuator>,
    functions: Vec<Function>,
    inputs: Vec<InputPort>,
    exports: Vec<Export>,
    flows: Vec<Flow>,
    end: End,
    places: Vec<Place>,
    origins: Vec<(u32, u32)>,
    probes: Vec<Probe>,
    trace: Vec<u32>,
});

wire_struct!(Layout {
    constants: u32,
    external: u32,
    state: u32,
    cells: u32
});
wire_struct!(PrimUse {
    name: String,
    signature: u64
});
wire_struct!(Cells { at: u32, len: u32 });
wire_struct!(Signal {
    at: u32,
    present: u32,
    ty: Type
});
wire_struct!(Fragment { path: String, parent: Option<u32>, active: u32, state: Cells });
wire_struct!(DevicePort {
    device: String,
    port: String,
    index: u32,
    ty: Type
});
wire_struct!(Sensor {
    port: DevicePort,
    value: Signal
});
wire_struct!(Actuator { port: DevicePort, inputs: Vec<Cells>, answers: Vec<(Answer, u32)> });
wire_struct!(Function { port: DevicePort, arguments: Vec<Cells>, results: Vec<Cells>, present: u32 });
wire_struct!(InputPort { key: String, value: Signal, updated: Option<Signal> });
wire_struct!(Export {
    key: String,
    value: Signal
});
wire_struct!(Flow {
    flow: CommandFlow,
    value: Signal
});
wire_struct!(EndResult {
    name: String,
    kind: EndKind,
    condition: Signal
});
wire_struct!(Place { path: String, flow: Option<String>, text: Option<TextRange> });
wire_struct!(TextRange {
    file: u32,
    start: u32,
    end: u32
});
wire_struct!(Probe {
    place: u32,
    port: String,
    value: Signal,
    fragment: u32
});

wire_enum!(Step {
    0 = Run { prim, form, at, len },
    1 = Copy { at, len },
    2 = Skip { unless, to },
    3 = Reset { unless, fragment },
    4 = Actuate { actuator },
    5 = Call { function },
});
wire_enum!(Form { 0 = Total, 1 = Optional });
wire_enum!(End { 0 = Results(results), 1 = Ports { terminate, fail } });
wire_enum!(EndKind { 0 = Finish, 1 = Yield, 2 = Fail });
wire_enum!(Answer { 0 = ConcurrentAccess, 1 = DeviceFailed, 2 = IllegalValue, 3 = ErrorCode, 4 = Completed });
wire_enum!(CommandFlow {
    0 = Cancel,
    1 = Takeover,
    2 = Time,
    3 = Period,
    4 = NetTime,
    5 = WallTime,
    6 = Predecessor,
    7 = Elapsed,
    8 = PeriodTicks,
});
wire_enum!(Type { 0 = One(scalar), 1 = Array(scalar, len), 2 = Matrix(rows, cols) });
wire_enum!(Scalar {
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
