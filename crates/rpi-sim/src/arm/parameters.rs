//! Parameters of an arm that programs set through ports: control strategy, tool load, impedances.

use super::port_table::Parameter;
use rpi_kin::MAX_AXES;

/// Number of stored parameter values: tool, impedance and sine at the tool, and the impedance of each joint.
const PARAMETERS: usize = 3 + MAX_AXES;
const LARGEST_PARAMETER: usize = 18;

/// Position control in the numbering of the KUKA LWR; 20 and 30 are Cartesian and joint impedance.
const POSITION_CONTROL: i64 = 10;

/// Indices of the numbers of [`Arm::load`] in a value of `tool_and_tcp`: mass, centre of mass as a pose, moments of
/// inertia, tool centre point as a pose. Only the positions of the poses are used.
const LOAD_INDICES: [usize; 10] = [0, 1, 2, 3, 8, 9, 10, 11, 12, 13];

/// Latest values of the parameters that programs set, such as the tool load. They have no effect on the simulated
/// motion.
#[derive(Clone, Debug)]
pub(super) struct Parameters {
    values: [[f64; LARGEST_PARAMETER]; PARAMETERS],
    /// The requested control strategy.
    pub(super) strategy: i64,
}

impl Parameters {
    pub(super) fn new() -> Self {
        Self {
            values: [[0.0; LARGEST_PARAMETER]; PARAMETERS],
            strategy: POSITION_CONTROL,
        }
    }

    /// Stores a value of a parameter, that of the axis `index` if each axis has its own.
    pub(super) fn store(&mut self, parameter: Parameter, index: usize, value: &[u64]) {
        if let Parameter::Strategy = parameter {
            self.strategy = value
                .first()
                .map_or(self.strategy, |bits| bits.cast_signed());
            return;
        }
        if let Some(kept) = self.values.get_mut(resource_index(parameter, index)) {
            for (k, slot) in kept.iter_mut().enumerate() {
                let k = match parameter {
                    Parameter::ToolAndTcp => LOAD_INDICES.get(k).copied(),
                    _ => Some(k),
                };
                let bits = k.and_then(|k| value.get(k));
                *slot = bits.map_or(*slot, |bits| f64::from_bits(*bits));
            }
        }
    }

    /// The tool load; see [`super::Arm::load`].
    pub(super) fn load(&self) -> &[f64] {
        &self.values[resource_index(Parameter::Tool, 0)][..10]
    }
}

/// True if an arm accepts a parameter: finite numbers, no negative mass, a known control strategy.
pub(super) fn accepts(parameter: Parameter, value: &[u64]) -> bool {
    let first = value.first().copied().unwrap_or_default();
    let finite = value.iter().all(|bits| f64::from_bits(*bits).is_finite());
    match parameter {
        Parameter::Strategy => matches!(first, 10 | 20 | 30),
        Parameter::Tool | Parameter::ToolAndTcp => finite && f64::from_bits(first) >= 0.0,
        _ => finite,
    }
}

/// Index of a parameter's values; also its resource number after those of the axes.
pub(super) fn resource_index(parameter: Parameter, index: usize) -> usize {
    match parameter {
        Parameter::Tool | Parameter::ToolAndTcp => 0,
        Parameter::ToolImpedance => 1,
        Parameter::ToolSine => 2,
        Parameter::JointImpedance => 3 + index,
        Parameter::Strategy => PARAMETERS,
    }
}
