//! Digital and analogue inputs and outputs.

use rpi_device::{DeviceBank, PortId, PortKind, Rejection, ResolveError};
use rpi_image::{Scalar, Type};

use crate::cell::{BOOL, REAL, actuator, bank, bits, find, reals, sensor};

#[test]
fn terminals_follow_their_script_and_keep_their_outputs() {
    let mut bank = bank();
    let input = sensor(&mut bank, "io", "in.bool", 1, BOOL);
    let (set, shown) = (
        actuator(&mut bank, "io", "out.real", 0, REAL),
        sensor(&mut bank, "io", "out.real", 0, REAL),
    );
    let mut seen = Vec::new();
    for tick in 0..2_000 {
        let mut cell = [7];
        assert!(bank.read(input, &mut cell));
        if seen.last().is_none_or(|(_, last)| *last != cell[0]) {
            seen.push((tick, cell[0]));
        }
        bank.step();
    }
    assert_eq!(seen, [(0, 0), (250, 1), (1000, 0), (1250, 1)]);
    assert_eq!(reals(&mut bank, shown, 1), [2.5]);
    bank.write(set, &bits(&[-4.0]));
    assert_eq!(reals(&mut bank, shown, 1), [-4.0]);
    assert_eq!(
        bank.check_set_point(set, &bits(&[f64::NAN])),
        Rejection::ILLEGAL_VALUE
    );
    bank.write(set, &bits(&[f64::NAN]));
    assert_eq!(reals(&mut bank, shown, 1), [-4.0]);
}

#[test]
fn all_terminals_can_be_read_and_set_at_once() {
    let mut bank = bank();
    let all = |scalar, count| Type::Array(scalar, count);
    let get = sensor(&mut bank, "io", "get", 0, all(Scalar::Bool, 2));
    let mut cells = [7, 7];
    assert!(bank.read(get, &mut cells));
    assert_eq!(cells, [1, 0]);
    let set = actuator(&mut bank, "io", "set", 0, all(Scalar::Bool, 2));
    let third = actuator(&mut bank, "io", "out.bool", 2, BOOL);
    assert!(bank.resources(set).contains(&bank.resource(third)));
    bank.write(set, &[1, 1]);
    let shown: Vec<PortId> = (0..3)
        .map(|index| sensor(&mut bank, "io", "out.bool", index, BOOL))
        .collect();
    let outputs: Vec<f64> = shown
        .iter()
        .flat_map(|port| reals(&mut bank, *port, 1))
        .collect();
    assert_eq!(bits(&outputs), [1, 1, 0], "the third is not among the two");
    let analogue = actuator(&mut bank, "io", "set", 0, all(Scalar::Real, 1));
    assert_eq!(
        bank.check_set_point(analogue, &bits(&[f64::NAN])),
        Rejection::ILLEGAL_VALUE.union(Rejection::KEEPS_VALUE)
    );
    let too_many = find(
        &mut bank,
        "io",
        "get",
        0,
        PortKind::Sensor,
        all(Scalar::Bool, 3),
    );
    assert_eq!(too_many, Err(ResolveError::WrongType));
}

#[test]
fn an_output_takes_its_safe_value_and_the_others_keep_theirs() {
    let mut bank = bank();
    let digital: Vec<PortId> = (0..3)
        .map(|index| actuator(&mut bank, "io", "out.bool", index, BOOL))
        .collect();
    let analogue = actuator(&mut bank, "io", "out.real", 0, REAL);
    let shown: Vec<PortId> = (0..3)
        .map(|index| sensor(&mut bank, "io", "out.bool", index, BOOL))
        .collect();
    let shown_analogue = sensor(&mut bank, "io", "out.real", 0, REAL);
    let outputs = |bank: &mut rpi_sim::SimBank| {
        let values: Vec<f64> = shown
            .iter()
            .flat_map(|port| reals(bank, *port, 1))
            .collect();
        (bits(&values), reals(bank, shown_analogue, 1)[0])
    };
    bank.write(digital[0], &[1]);
    bank.make_safe(bank.resource(digital[0]));
    assert_eq!(
        outputs(&mut bank),
        (vec![1, 0, 0], 2.5),
        "without a safe value"
    );
    bank.make_safe(bank.resource(digital[1]));
    assert_eq!(outputs(&mut bank), (vec![1, 1, 0], 2.5));
    bank.make_safe(bank.resource(analogue));
    assert_eq!(outputs(&mut bank), (vec![1, 1, 0], -1.0));
    bank.step();
    bank.write(digital[1], &[0]);
    assert!(bank.make_all_safe(), "an output changes");
    assert_eq!(outputs(&mut bank), (vec![1, 1, 0], -1.0));
    bank.step();
    assert!(!bank.make_all_safe(), "nothing changes any more");
}
