//! Declarations of primitives: names, ports, parameters, state and role. The type checker, the importer, hover texts,
//! the generated reference, the lowering and the loader read them; the code of a primitive is in `rpi-prims`.

use crate::types::{Scalar, Type};
use crate::value::Value;

// All fields are `'static` or `fn` pointers, so that a declaration is a `const` and the registry is built at compile
// time.
/// Declaration of one primitive (basic operation of a net): name, ports, parameters, state, role and bound of the work.
#[derive(Clone, Copy, Debug)]
pub struct PrimDesc {
    /// Name of the primitive in the registry, for example `Core::DoubleAdd`.
    pub name: &'static str,
    /// Documentation of the primitive: the operation, units, frames and source.
    pub doc: &'static str,
    /// In-ports of the primitive, in declaration order.
    pub inputs: &'static [InPort],
    /// Out-ports of the primitive, in declaration order.
    pub outputs: &'static [OutPort],
    /// Parameters in declaration order, without those that replace an unconnected in-port (see [`InPort::fallback`]).
    pub params: &'static [Param],
    /// Rule that gives the lengths of array out-ports and the shapes of matrix out-ports.
    pub shape: ShapeRule,
    /// Memory that the primitive preserves from one cycle to the next.
    pub state: StateSize,
    /// Way in which the core handles the primitive: as code, or as an interface to devices, inputs or the core itself.
    pub role: Role,
    /// Upper bound of the work in one cycle, in elementary operations (the addition of two reals is 1). Larger arrays
    /// and matrices multiply it by [`Type::work_factor`].
    pub work: u32,
    /// True if the primitive can raise a fault in a cycle, such as an integer overflow or a division by zero.
    pub may_fault: bool,
}

/// In-port of a primitive: name, accepted type, and behaviour without a connection.
#[derive(Clone, Copy, Debug)]
pub struct InPort {
    /// Name of the in-port in the declaration of the primitive, for example `inFirst`.
    pub name: &'static str,
    /// Type of the values that the port accepts.
    pub ty: PortType,
    /// Behaviour if nothing is connected to the port: an error, a parameter instead, or an absent value.
    pub fallback: Fallback,
}

/// Out-port of a primitive: name and type.
#[derive(Clone, Copy, Debug)]
pub struct OutPort {
    /// Name of the out-port in the declaration of the primitive, for example `outValue`.
    pub name: &'static str,
    /// Type of the values of the out-port.
    pub ty: PortType,
    /// Rule that gives the presence of the output from the presence of the inputs.
    pub presence: Presence,
}

/// Type that a primitive declares for a port, before array lengths and matrix shapes are known.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PortType {
    /// Port for single values of this scalar type.
    Scalar(Scalar),
    /// Port for arrays of this element type. The length of an in-port is that of the connected flow; the length of an
    /// out-port follows from [`PrimDesc::shape`].
    Array(Scalar),
    /// Port for matrices of reals. The shape of an in-port is that of the connected flow; the shape of an out-port
    /// follows from [`PrimDesc::shape`].
    Matrix,
}

/// Rule that derives the lengths of array out-ports and the shapes of matrix out-ports from inputs and parameters.
/// [`PrimDesc::out_type`] applies it.
#[derive(Clone, Copy, Debug)]
pub enum ShapeRule {
    /// The primitive has no array or matrix out-port, and the sizes of its inputs need no check.
    Fixed,
    /// The array out-port is as long as the value of the integer parameter with this name.
    FromParam(&'static str),
    /// Each array out-port is as long as the value of the integer parameter with the name at its index.
    FromParams(&'static [&'static str]),
    /// The array out-port is as long as the array in-port with this index.
    SameAsInput(usize),
    /// The array out-port is as long as the array parameter with this name.
    SameAsParam(&'static str),
    /// The function returns the type of the out-port, or `None` if sizes or indices of the inputs do not fit. It is
    /// also called for primitives with a scalar out-port, to check the sizes of their inputs.
    Computed(fn(&ShapeArgs<'_>) -> Option<Type>),
}

/// Input types and parameter values from which a shape rule ([`ShapeRule`]) derives the type of an out-port.
#[derive(Clone, Copy, Debug)]
pub struct ShapeArgs<'a> {
    /// Types of the in-ports in declaration order; `None` for a port that is neither connected nor replaced by a
    /// parameter.
    pub inputs: &'a [Option<Type>],
    /// Values of the parameters, in the order of [`PrimDesc::params`].
    pub params: &'a [Value],
}

impl ShapeArgs<'_> {
    /// Returns the value of the integer parameter with index `param`, used as a size or as an index; `None` if it is
    /// missing, negative or above `u32::MAX`.
    #[must_use]
    pub fn size(&self, param: usize) -> Option<u32> {
        self.params
            .get(param)?
            .as_int()
            .and_then(|v| u32::try_from(v).ok())
    }

    /// Returns the length of the array in-port with index `input`; `None` if it is not an array.
    #[must_use]
    pub fn len(&self, input: usize) -> Option<u32> {
        match self.inputs.get(input)? {
            Some(Type::Array(_, n)) => Some(*n),
            _ => None,
        }
    }

    /// Returns the numbers of rows and columns of the matrix in-port with index `input`; `None` if it is not a matrix.
    #[must_use]
    pub fn shape(&self, input: usize) -> Option<(u32, u32)> {
        match self.inputs.get(input)? {
            Some(Type::Matrix(rows, cols)) => Some((*rows, *cols)),
            _ => None,
        }
    }
}

/// Behaviour of an in-port to which nothing is connected.
#[derive(Clone, Copy, Debug)]
pub enum Fallback {
    /// The port must be connected; otherwise the net is rejected.
    Required,
    /// The parameter with this name replaces the connection. The second field is the default of that parameter.
    Param(&'static str, ParamDefault),
    /// A value computed from several real parameters replaces the connection. The fields are the names of the
    /// parameters with their defaults, and the function that computes the value from the parameters in the same order.
    ComposedOfParams(&'static [(&'static str, f64)], fn(&[f64]) -> Value),
    /// The port reads an absent value.
    AbsentValue,
}

/// Default of a parameter. Unlike [`Value`], it can be written in a `const`.
#[derive(Clone, Copy, Debug)]
pub enum ParamDefault {
    /// Neutral value of the type of the parameter: false, 0, zero vector or identity, see [`Value::neutral`].
    Neutral,
    /// Default of a Boolean parameter.
    Bool(bool),
    /// Default of an integer parameter.
    Int(i64),
    /// Default of a parameter that is a real.
    Real(f64),
    /// Default of a text parameter.
    Str(&'static str),
    /// No default: a net must set the parameter.
    Required,
}

impl ParamDefault {
    /// Returns the default as a value of type `ty`; `None` for [`ParamDefault::Required`]. Only
    /// [`ParamDefault::Neutral`] depends on `ty`.
    #[must_use]
    pub fn value(self, ty: Type) -> Option<Value> {
        Some(match self {
            ParamDefault::Neutral => Value::neutral(ty),
            ParamDefault::Bool(v) => Value::bool(v),
            ParamDefault::Int(v) => Value::int(v),
            ParamDefault::Real(v) => Value::real(v),
            ParamDefault::Str(v) => Value::Str(v.into()),
            ParamDefault::Required => return None,
        })
    }
}

/// Parameter of a primitive: a constant, fixed when the command is loaded.
#[derive(Clone, Copy, Debug)]
pub struct Param {
    /// Name of the parameter in the declaration of the primitive, for example `Duration`.
    pub name: &'static str,
    /// Type that an argument for the parameter must have.
    pub ty: ParamType,
    /// Value that the parameter has in a net that does not set it.
    pub default: ParamDefault,
}

/// Type of a parameter of a primitive, whose value is fixed when the net is loaded.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ParamType {
    /// Parameter with a single value of this scalar type.
    Scalar(Scalar),
    /// Parameter with an array of this element type, of any length.
    Array(Scalar),
    /// Parameter whose value is a text, such as the name of a device.
    Str,
}

/// Rule that states whether an output has a value in a cycle (is present), as far as the presence of the inputs decides
/// it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Presence {
    /// Present exactly if every connected input is present. The code of the primitive never handles absence: it has
    /// only the form [`Form::Total`](crate::image::Form::Total), and a primitive with state does not run in a cycle in
    /// which an input is absent.
    Strict,
    /// Present if all connected inputs are present, as for the three-valued (Kleene) `and`. If an input is absent, the
    /// code of the primitive decides.
    IfAll,
    /// Present if at least one input is present, as for the operator `??`. If all inputs are absent, the code of the
    /// primitive decides.
    IfAny,
    /// Present in every cycle, even if inputs are absent.
    Always,
    /// The code of the primitive decides. The output may be absent even if all inputs are present, as for `pre`.
    Maybe,
}

/// Size of the memory that a primitive preserves from one cycle to the next, in slots of 64 bits. The initial content
/// is zero unless the primitive has an `init` function.
#[derive(Clone, Copy, Debug)]
pub enum StateSize {
    /// The primitive has no state.
    None,
    /// The state has this number of slots. In the code of an image, the operand for the state is one word: the index of
    /// the first slot.
    Fixed(u32),
    /// The function computes the number of slots from the parameters and the period of the command. In the code of an
    /// image, the operand for the state has two words: the index of the first slot and the number of slots.
    Computed(fn(&SizeArgs<'_>) -> u32),
}

/// Arguments of the function that computes the size of a state ([`StateSize::Computed`]).
#[derive(Clone, Copy, Debug)]
pub struct SizeArgs<'a> {
    /// Values of the parameters, in the order of [`PrimDesc::params`].
    pub params: &'a [Value],
    /// Period of the command, the time between two of its cycles, in seconds.
    pub dt: f64,
}

impl SizeArgs<'_> {
    /// Returns the number of cycles in the time given by the real parameter with index `param`, in seconds. The result
    /// is rounded up and lies between 0 and `u32::MAX`; it is 0 for a missing parameter.
    #[must_use]
    pub fn cycles_of_param(&self, param: usize) -> u32 {
        let span = self.params.get(param).and_then(Value::as_real);
        let cycles = span.unwrap_or(0.0) / self.dt;
        let whole = cycles as u32;
        whole.saturating_add(u32::from(cycles > f64::from(whole)))
    }
}

/// Way in which the core executes a primitive: by code of the primitive, or as an access to a device, an input, an
/// export or a flow of the core.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Role {
    /// The code of the primitive computes the outputs from the inputs, after the primitives that produce the inputs.
    Compute,
    /// Outputs the value of the parameter `Value`. The compiler replaces the primitive by a constant slot.
    Constant,
    /// Delay (`pre`): outputs the value and the presence that its first input had in the previous active cycle. The
    /// output is absent in the first cycle. The input is stored in the commit phase, at the end of the cycle.
    Delay,
    /// Outputs true exactly if the input is absent. No code runs: the output is the negation of the presence of the
    /// input.
    IsAbsent,
    /// Outputs true in the first cycle in which the enclosing fragment is active, and in the first one after each
    /// reset; else false.
    First,
    /// Outputs values of a device, which the core reads before the evaluation of the cycle, even if the enclosing
    /// fragment is inactive.
    Sensor(DeviceUse),
    /// Passes its inputs to a device as one set-point: the slots of all inputs, concatenated. The core checks the
    /// set-point when its step runs, and hands it over in the write phase after the evaluation. The out-ports are
    /// responses of the device ([`DeviceUse::responses`]).
    Actuator(DeviceUse),
    /// Calls a function of a device, such as inverse kinematics. The arguments are the slots of all inputs,
    /// concatenated; the result fills the slots of all outputs. If the device returns no result, an output with
    /// [`Presence::Maybe`] is absent, and an output with [`Presence::Strict`] is NaN.
    DeviceFunction(DeviceUse),
    /// Calls a function in C that is defined outside of the program. The text parameter with this name has its
    /// signature, see [`ExternalFunction`](crate::external::ExternalFunction).
    ExternalFunction(&'static str),
    /// Outputs a value that the host of the command sets under a key, between two cycles.
    Input,
    /// Publishes the value of its input under a key at the end of the cycle.
    Export,
    /// Outputs a flow that the core provides, such as the time or a cancel request.
    Flow(CommandFlow),
}

/// Device port that a primitive uses. Parameters of the primitive select the device.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DeviceUse {
    /// Name of the text parameter of the primitive whose value is the name of the device.
    pub device: &'static str,
    /// Name of the integer parameter whose value is an index (number of an axis or of an input), if the device has
    /// several ports of this name; else `None`.
    pub index: Option<&'static str>,
    /// Names of the device ports: one for each out-port of a sensor, exactly one for an actuator or a function.
    pub ports: DevicePortNames,
    /// Meaning of each out-port of an actuator; empty for a sensor or a function.
    pub responses: &'static [DeviceResponse],
}

/// Response of a device to the set-point of the current cycle. An actuator primitive has an out-port for each response
/// it declares.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum DeviceResponse {
    /// True if another actuator primitive has set the same port of the device in the same cycle.
    ConcurrentAccess,
    /// True if the device has failed, so that it does not carry out the set-point.
    DeviceFailed,
    /// True if the set-point is unreachable, outside the limits of the device or not a number.
    IllegalValue,
    /// Error code of the device as an integer; 0 if the device has no error.
    ErrorCode,
    /// True if the device has accepted the set-point of the previous cycle and has no error.
    Completed,
}

/// Names of the device ports that a primitive uses.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DevicePortNames {
    /// The primitive always uses the ports with these names.
    Fixed(&'static [&'static str]),
    /// The name of the port is the value of the text parameter with this name.
    Param(&'static str),
}

/// Flow that the core computes and provides to a command in each cycle, such as the time or a cancel request.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum CommandFlow {
    /// Boolean: true from the first cycle after a client has requested the command to end.
    Cancel,
    /// Boolean: true if a successor is scheduled whose devices include every resource that may be moving.
    Takeover,
    /// Time since the first cycle of the command, in seconds (real).
    Time,
    /// Period of the command, the time between two of its cycles, in seconds (real).
    Period,
    /// Logical time of the cycle, in ns since the Unix epoch ([`Scalar::Time`]): the system time at the first cycle of
    /// the command, advanced by one period in each further cycle.
    NetTime,
    /// Time of the system clock at the evaluation of the cycle, in ns since the Unix epoch ([`Scalar::Time`]).
    WallTime,
    /// Hash of the result with which the preceding command ended ([`crate::hash::result_id`], integer); absent if there
    /// is no preceding command.
    Predecessor,
    /// Time since the first cycle of the command, in ticks of the core (integer).
    Elapsed,
    /// Period of the command, in ticks of the core (integer).
    PeriodTicks,
    /// Speed override of the operator for all motions of the core, from 0 (standstill) to 1 (programmed speed) (real).
    SpeedOverride,
    /// Boolean: true while the operator pauses all motions.
    Pause,
}

impl PrimDesc {
    /// Returns the index of the in-port with this name in [`PrimDesc::inputs`]; `None` if there is none.
    #[must_use]
    pub fn input(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|p| p.name == name)
    }

    /// Returns the index of the out-port with this name in [`PrimDesc::outputs`]; `None` if there is none.
    #[must_use]
    pub fn output(&self, name: &str) -> Option<usize> {
        self.outputs.iter().position(|p| p.name == name)
    }

    /// Returns the index of the parameter with this name in [`PrimDesc::params`]; `None` if there is none. A parameter
    /// that replaces an in-port is not in that list.
    #[must_use]
    pub fn param(&self, name: &str) -> Option<usize> {
        self.params.iter().position(|p| p.name == name)
    }

    /// Returns the index of the in-port whose missing connection the parameter `name` replaces; `None` if there is
    /// none.
    #[must_use]
    pub fn in_port_of_param(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|p| match p.fallback {
            Fallback::Param(n, _) => n == name,
            Fallback::ComposedOfParams(names, _) => names.iter().any(|(n, _)| *n == name),
            Fallback::Required | Fallback::AbsentValue => false,
        })
    }

    /// Returns the type of the out-port with index `port` for the given in-port types and parameters; `None` if the
    /// sizes of the inputs or parameters do not fit the primitive.
    #[must_use]
    pub fn out_type(&self, port: usize, args: &ShapeArgs<'_>) -> Option<Type> {
        if let ShapeRule::Computed(of) = self.shape {
            return of(args);
        }
        match self.outputs.get(port)?.ty {
            PortType::Scalar(s) => Some(Type::Scalar(s)),
            PortType::Array(s) => self.derived_len(port, args).map(|n| Type::Array(s, n)),
            PortType::Matrix => None,
        }
    }

    fn derived_len(&self, port: usize, args: &ShapeArgs<'_>) -> Option<u32> {
        match self.shape {
            ShapeRule::Fixed | ShapeRule::Computed(_) => None,
            ShapeRule::FromParam(name) => args.size(self.param(name)?),
            ShapeRule::FromParams(names) => args.size(self.param(names.get(port)?)?),
            ShapeRule::SameAsInput(input) => args.len(input),
            ShapeRule::SameAsParam(name) => match args.params.get(self.param(name)?)?.ty()? {
                Type::Array(_, n) => Some(n),
                _ => None,
            },
        }
    }
}
