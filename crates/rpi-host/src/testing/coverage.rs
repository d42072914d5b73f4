//! What a test has seen of a net: fragments that were active, choices that went either way.

use rpi_core::Machine;
use rpi_image::Image;
use rpi_image::image::Signal;

/// What was seen so far.
#[derive(Clone, Debug)]
pub struct Coverage {
    /// For each fragment but the root: its path, and whether it was ever active.
    pub fragments: Vec<(String, bool)>,
    /// For each choice: whether it was ever false, and ever true.
    pub branches: Vec<[bool; 2]>,
    conditions: Vec<Option<(Signal, u32)>>,
}

impl Coverage {
    pub(super) fn new(image: &Image, branches: &[String]) -> Coverage {
        let inner = image.fragments.iter().skip(1);
        let condition = |name: &String| {
            let probe = image.probes.iter().find(|p| image.probe_name(p) == *name);
            probe.map(|probe| (probe.value, probe.fragment))
        };
        Coverage {
            fragments: inner.map(|f| (f.path.clone(), false)).collect(),
            branches: vec![[false; 2]; branches.len()],
            conditions: branches.iter().map(condition).collect(),
        }
    }

    pub(super) fn look(&mut self, machine: &Machine) {
        for (k, fragment) in (1..).zip(&mut self.fragments) {
            fragment.1 |= machine.is_active(k);
        }
        for (seen, condition) in self.branches.iter_mut().zip(&self.conditions) {
            let Some((signal, fragment)) = condition else {
                continue;
            };
            if machine.is_active(*fragment)
                && let Some(value) = machine.value(*signal)
            {
                seen[usize::from(value[0] != 0)] = true;
            }
        }
    }
}
