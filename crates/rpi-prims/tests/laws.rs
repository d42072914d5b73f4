//! Properties of all primitives with code, tested on random and on extreme inputs.

mod common;

use common::{Form, TestBench, value_of};
use rpi_image::{Presence, PrimDesc, Role, Scalar, Type, Value};
use rpi_prims::{Prim, registry};

rpi_testkit::trap_allocations!();

/// Deterministic pseudo-random number generator (SplitMix64).
struct Random(u64);

impl Random {
    fn roll(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn real(&mut self) -> f64 {
        (self.roll() >> 11) as f64 / (1_u64 << 53) as f64 * 4.0 - 2.0
    }

    /// Returns a typical value of a type.
    fn value(&mut self, ty: Type) -> Value {
        let scalar = match ty {
            Type::Scalar(s) | Type::Array(s, _) => s,
            Type::Matrix(..) => Scalar::Real,
        };
        let each = scalar.slots().max(1);
        let count = ty.slots() / each;
        let cells = (0..count).flat_map(|_| self.one(scalar)).collect();
        Value::Slots { ty, cells }
    }

    fn one(&mut self, scalar: Scalar) -> Vec<u64> {
        match scalar {
            Scalar::Bool => vec![self.roll() & 1],
            Scalar::Int => vec![(self.roll() % 21).wrapping_sub(10)],
            Scalar::Time => vec![self.roll() >> 4],
            Scalar::Rotation => self.rotation(),
            Scalar::Pose => [self.reals(3), self.rotation()].concat(),
            _ => self.reals(scalar.slots()),
        }
    }

    fn reals(&mut self, count: u32) -> Vec<u64> {
        (0..count).map(|_| self.real().to_bits()).collect()
    }

    fn rotation(&mut self) -> Vec<u64> {
        let r = rpi_prims::geometry::from_abc(self.real(), self.real(), self.real());
        [r.i, r.j, r.k, r.w].map(f64::to_bits).to_vec()
    }

    /// Returns an extreme value of a type.
    fn extreme(&mut self, ty: Type) -> Value {
        const REALS: [f64; 8] = [
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            0.0,
            -0.0,
            f64::MAX,
            f64::MIN_POSITIVE,
            -1.0,
        ];
        const INTS: [i64; 6] = [i64::MIN, i64::MAX, -1, 0, 1, 64];
        let mut value = self.value(ty);
        let Value::Slots { cells, .. } = &mut value else {
            return value;
        };
        let scalar = match ty {
            Type::Scalar(s) | Type::Array(s, _) => s,
            Type::Matrix(..) => Scalar::Real,
        };
        for cell in cells {
            let roll = self.roll() as usize;
            match scalar {
                Scalar::Bool => {}
                Scalar::Int | Scalar::Time => *cell = INTS[roll % INTS.len()].cast_unsigned(),
                _ => *cell = REALS[roll % REALS.len()].to_bits(),
            }
        }
        value
    }
}

fn with_code() -> impl Iterator<Item = &'static Prim> {
    registry().iter().filter(|p| p.desc.role == Role::Compute)
}

fn all_present(desc: &PrimDesc, outputs: &[Option<Value>]) {
    for (port, value) in desc.outputs.iter().zip(outputs) {
        let sure = port.presence != Presence::Maybe;
        assert!(!sure || value.is_some(), "{}.{}", desc.name, port.name);
    }
}

#[test]
fn both_forms_agree_where_all_inputs_are_present() {
    let mut dice = Random(1);
    for prim in with_code().filter(|p| p.total.is_some() && p.optional.is_some()) {
        let mut total = TestBench::with_form(prim.desc.name, &[], Form::Total);
        let mut optional = TestBench::with_form(prim.desc.name, &[], Form::Optional);
        for _ in 0..50 {
            let inputs: Vec<_> = total
                .types()
                .into_iter()
                .map(|ty| Some(dice.value(ty)))
                .collect();
            let outputs = optional.step(&inputs);
            all_present(&prim.desc, &outputs);
            assert_eq!(total.step(&inputs), outputs, "{}", prim.desc.name);
            assert_eq!(total.fault, optional.fault, "{}", prim.desc.name);
        }
    }
}

#[test]
fn forms_go_with_presence() {
    for prim in with_code() {
        let every = |presence| {
            !prim.desc.outputs.is_empty()
                && prim.desc.outputs.iter().all(|o| o.presence == presence)
        };
        if every(Presence::Strict) {
            assert!(
                prim.total.is_some() && prim.optional.is_none(),
                "{}",
                prim.desc.name
            );
        }
        if every(Presence::Maybe) {
            assert!(
                prim.total.is_none() && prim.optional.is_some(),
                "{}",
                prim.desc.name
            );
        }
    }
}

#[test]
fn outputs_are_as_present_as_declared() {
    let mut dice = Random(2);
    for prim in with_code().filter(|p| p.optional.is_some()) {
        let mut rig = TestBench::new(prim.desc.name, &[]);
        for _ in 0..200 {
            let inputs: Vec<_> = rig
                .types()
                .into_iter()
                .map(|ty| (!dice.roll().is_multiple_of(3)).then(|| dice.value(ty)))
                .collect();
            let any = inputs.iter().any(Option::is_some);
            for (port, value) in prim.desc.outputs.iter().zip(rig.step(&inputs)) {
                let sure = match port.presence {
                    Presence::Always => true,
                    Presence::IfAny => any,
                    Presence::IfAll | Presence::Strict => !inputs.contains(&None),
                    Presence::Maybe => false,
                };
                assert!(!sure || value.is_some(), "{}.{}", prim.desc.name, port.name);
            }
        }
    }
}

#[test]
fn a_reset_makes_it_as_new() {
    let mut dice = Random(3);
    for prim in with_code() {
        let Some(reset) = prim.desc.input("inReset") else {
            continue;
        };
        let mut used = TestBench::new(prim.desc.name, &[]);
        for _ in 0..40 {
            let inputs: Vec<_> = used
                .types()
                .into_iter()
                .map(|ty| Some(dice.value(ty)))
                .collect();
            used.step(&inputs);
        }
        let mut fresh = TestBench::new(prim.desc.name, &[]);
        for k in 0..20 {
            let mut inputs: Vec<_> = used
                .types()
                .into_iter()
                .map(|ty| Some(dice.value(ty)))
                .collect();
            inputs[reset] = Some(value_of(k == 0));
            assert_eq!(
                used.step(&inputs),
                fresh.step(&inputs),
                "{} cycle {k}",
                prim.desc.name
            );
        }
    }
}

#[test]
fn the_same_inputs_give_the_same_bits() {
    for prim in with_code() {
        let run = || {
            let (mut dice, mut rig) = (Random(4), TestBench::new(prim.desc.name, &[]));
            let mut step = || {
                let inputs: Vec<_> = rig
                    .types()
                    .into_iter()
                    .map(|ty| Some(dice.extreme(ty)))
                    .collect();
                rig.step(&inputs)
            };
            (0..20).map(|_| step()).collect::<Vec<_>>()
        };
        let bits = |outputs: Vec<Vec<Option<Value>>>| format!("{outputs:?}");
        assert_eq!(bits(run()), bits(run()), "{}", prim.desc.name);
    }
}

#[test]
fn nothing_panics_on_extreme_inputs_and_only_the_declared_ones_fault() {
    let mut dice = Random(5);
    for prim in with_code() {
        let mut rig = TestBench::new(prim.desc.name, &[]);
        for _ in 0..100 {
            let inputs: Vec<_> = rig
                .types()
                .into_iter()
                .map(|ty| Some(dice.extreme(ty)))
                .collect();
            rig.step(&inputs);
            assert!(
                rig.fault.is_none() || prim.desc.may_fault,
                "{} faults",
                prim.desc.name
            );
        }
    }
}

#[test]
fn absurd_parameters_are_no_panic() {
    let params = [f64::NAN, f64::INFINITY, -1.0, 0.0].map(value_of);
    for prim in with_code() {
        for value in &params {
            let reals = prim
                .desc
                .params
                .iter()
                .filter(|p| p.ty == rpi_image::ParamType::Scalar(Scalar::Real));
            let given: Vec<_> = reals.map(|p| (p.name, value.clone())).collect();
            let infinite = common::get::<f64>(value) == f64::INFINITY;
            let sized = matches!(prim.desc.state, rpi_image::StateSize::Computed(_));
            if given.is_empty() || (infinite && sized) {
                continue;
            }
            let (mut dice, mut rig) = (Random(6), TestBench::new(prim.desc.name, &given));
            for _ in 0..10 {
                let inputs: Vec<_> = rig
                    .types()
                    .into_iter()
                    .map(|ty| Some(dice.value(ty)))
                    .collect();
                rig.step(&inputs);
            }
        }
    }
}

#[test]
fn guarded_operations_fault_only_where_they_count() {
    let guarded = with_code().filter(|p| p.desc.name.starts_with("Rpi::Guarded"));
    let mut seen = 0;
    for prim in guarded {
        let name = prim.desc.name.replace("Guarded", "");
        let plain = ["Rpi::", "Core::"].map(|space| name.replace("Rpi::", space));
        let plain = plain
            .iter()
            .find(|name| rpi_prims::PrimId::from_name(name).is_some());
        let mut plain = TestBench::new(plain.expect("an operation without a guard"), &[]);
        let mut rig = TestBench::new(prim.desc.name, &[]);
        let mut dice = Random(7);
        for _ in 0..100 {
            let operands: Vec<_> = plain
                .types()
                .into_iter()
                .map(|ty| Some(dice.extreme(ty)))
                .collect();
            let with = |active: bool| [vec![Some(value_of(active))], operands.clone()].concat();
            assert_eq!(
                (rig.step(&with(true)), rig.fault),
                (plain.step(&operands), plain.fault),
                "{}",
                prim.desc.name
            );
            assert_eq!(
                (rig.step(&with(false)), rig.fault),
                (vec![Some(value_of(0_i64))], None),
                "{}",
                prim.desc.name
            );
        }
        seen += 1;
    }
    assert_eq!(seen, 10);
}
