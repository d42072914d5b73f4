//! Algebraic identities of primitives that the passes use. The meaning of a primitive is defined by its declaration; a
//! test checks every identity against the primitive's own code.

use crate::registers::Register;
use rpi_prims::{PrimId, registry};
use std::sync::LazyLock;

/// Algebraic identity that allows the passes to simplify calls of a primitive.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Identity {
    /// A Boolean function of two inputs. If one input is the constant `neutral`, the result is the other input; if one
    /// is `absorbing`, the result is `absorbing`.
    Gate {
        neutral: Register,
        absorbing: Register,
    },
    /// Operation `not x`, which is its own inverse.
    Negation,
    /// Choice of three inputs: the second input if the first is true, else the third.
    Choice,
}

/// Returns the algebraic identity of a primitive; `None` if none is known.
pub(super) fn identity_of(prim: PrimId) -> Option<Identity> {
    static LAWS: LazyLock<Vec<Option<Identity>>> =
        LazyLock::new(|| registry().iter().map(|p| by_name(p.desc.name)).collect());
    LAWS.get(usize::from(prim.0)).copied().flatten()
}

fn by_name(name: &str) -> Option<Identity> {
    match name {
        "Core::BooleanAnd" => Some(Identity::Gate {
            neutral: Register::TRUE,
            absorbing: Register::FALSE,
        }),
        "Core::BooleanOr" => Some(Identity::Gate {
            neutral: Register::FALSE,
            absorbing: Register::TRUE,
        }),
        "Core::BooleanNot" => Some(Identity::Negation),
        name if name.ends_with("Conditional") => Some(Identity::Choice),
        _ => None,
    }
}

/// Returns the register that always equals the result of an `and` or `or` of `a` and `b`. `None` unless one of them is
/// the `neutral` or `absorbing` constant of the operation, or both are the same register.
pub(super) fn simplify_gate(
    a: Register,
    b: Register,
    neutral: Register,
    absorbing: Register,
) -> Option<Register> {
    match (a, b) {
        _ if a == absorbing || b == absorbing => Some(absorbing),
        _ if a == neutral || a == b => Some(b),
        _ if b == neutral => Some(a),
        _ => None,
    }
}

/// Returns the register that always equals the result of a choice. `None` unless the condition is constant or both
/// alternatives are the same register.
pub(super) fn simplify_choice(
    condition: Register,
    yes: Register,
    no: Register,
) -> Option<Register> {
    match condition {
        Register::TRUE => Some(yes),
        Register::FALSE => Some(no),
        _ => (yes == no).then_some(yes),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rpi_image::{PortType, Scalar};
    use rpi_prims::{Context, CycleTime, NoDevices};

    /// Runs the total form of a primitive and returns its first `cells_out` output slots.
    fn run(prim: PrimId, inputs: &[Vec<u64>], cells_out: usize) -> Vec<u64> {
        let (mut cells, mut words) = (Vec::new(), Vec::new());
        for input in inputs {
            words.push(cells.len() as u32);
            cells.extend(input);
        }
        let out = cells.len();
        words.push(out as u32);
        cells.resize(out + cells_out, 7);
        let mut cx = Context {
            slots: &mut cells,
            time: CycleTime::FIRST,
            devices: &mut NoDevices,
            fault: None,
        };
        prim.prim().total.expect("a total form")(&mut cx, &words);
        cells.split_off(out)
    }

    #[test]
    fn the_laws_hold_for_the_code() {
        let mut seen = 0;
        for k in 0..registry().len() {
            let prim = PrimId(u16::try_from(k).unwrap());
            let Some(law) = identity_of(prim) else {
                continue;
            };
            seen += 1;
            match law {
                Identity::Gate { neutral, absorbing } => {
                    for x in [0, 1] {
                        let (n, a) = (u64::from(neutral.0), u64::from(absorbing.0));
                        assert_eq!(run(prim, &[vec![n], vec![x]], 1), [x]);
                        assert_eq!(run(prim, &[vec![x], vec![n]], 1), [x]);
                        assert_eq!(run(prim, &[vec![a], vec![x]], 1), [a]);
                        assert_eq!(run(prim, &[vec![x], vec![a]], 1), [a]);
                        assert_eq!(run(prim, &[vec![x], vec![x]], 1), [x]);
                    }
                }
                Identity::Negation => {
                    assert_eq!(run(prim, &[vec![0]], 1), [1]);
                    assert_eq!(run(prim, &[vec![1]], 1), [0]);
                }
                Identity::Choice => {
                    let PortType::Scalar(scalar) = prim.desc().outputs[0].ty else {
                        panic!("a choice of {:?}", prim.desc().outputs[0].ty);
                    };
                    let width = scalar.slots() as usize;
                    let is_bool = scalar == Scalar::Bool;
                    let yes: Vec<u64> = (0..width as u64)
                        .map(|k| if is_bool { 1 } else { k + 3 })
                        .collect();
                    let no: Vec<u64> = (0..width as u64)
                        .map(|k| if is_bool { 0 } else { k + 9 })
                        .collect();
                    assert_eq!(run(prim, &[vec![1], yes.clone(), no.clone()], width), yes);
                    assert_eq!(run(prim, &[vec![0], yes.clone(), no.clone()], width), no);
                }
            }
        }
        assert!(seen > 10, "the primitives have other names now");
    }
}
