//! Tests of matrices, arrays and arrays of bits by example: parameters, inputs and expected outputs.

mod common;

use common::golden::{check, same};
use common::{TestBench, array, get, matrix, reals, value_of};
use rpi_image::{Scalar, Type, Value};

rpi_testkit::trap_allocations!();

const A: [[f64; 3]; 3] = [[2.0, 1.0, 0.0], [1.0, 3.0, 1.0], [0.0, 1.0, 4.0]];

#[test]
fn matrices() {
    let a = matrix(A);
    let x = array(&[1.0, -2.0, 3.0]);
    let ax = array(&[0.0, -2.0, 10.0]);
    let square = [[5.0, 5.0, 1.0], [5.0, 11.0, 7.0], [1.0, 7.0, 17.0]];
    check(&[
        (
            "Core::MatrixApply",
            &[a.clone(), x.clone()],
            std::slice::from_ref(&ax),
        ),
        ("Core::MatrixSolve", &[a.clone(), ax.clone()], &[x]),
        (
            "Core::MatrixMultiply",
            &[a.clone(), a.clone()],
            &[matrix(square)],
        ),
        (
            "Core::MatrixTranspose",
            &[matrix([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]])],
            &[matrix([[1.0, 4.0, 7.0], [2.0, 5.0, 8.0], [3.0, 6.0, 9.0]])],
        ),
        (
            "Core::MatrixScale",
            &[a.clone(), value_of(2.0)],
            &[matrix(A.map(|row| row.map(|v| 2.0 * v)))],
        ),
    ]);
    let singular = matrix([[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [0.0, 0.0, 1.0]]);
    let out =
        TestBench::new("Core::MatrixSolve", &[]).step_present(&[singular, array(&[1.0, 0.0, 0.0])]);
    assert!(reals(&out[0]).iter().all(|v| v.is_nan()));
}

fn with(name: &str, params: &[(&str, i64)], inputs: &[Value]) -> Value {
    let params: Vec<_> = params
        .iter()
        .map(|(name, value)| (*name, value_of(*value)))
        .collect();
    TestBench::new(name, &params).step_present(inputs).remove(0)
}

fn check_selection(matrices: &[Value]) {
    let select = [
        ("SelectedRows", array(&[2_i64, 0])),
        ("SelectedCols", array(&[1_i64])),
    ];
    let selected = TestBench::new("Core::MatrixSelect", &select).step_present(matrices);
    same("selected", &selected, &[matrix([[8.0], [2.0]])]);
}

#[test]
fn parts_of_matrices() {
    let counted = matrix([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]]);
    let of_counted = std::slice::from_ref(&counted);
    let corner = [
        ("StartRow", 1),
        ("StartCol", 1),
        ("BlockWidth", 2),
        ("BlockHeight", 2),
    ];
    same(
        "get",
        &[with(
            "Core::MatrixGet",
            &[("Row", 1), ("Col", 2)],
            of_counted,
        )],
        &[value_of(6.0)],
    );
    same(
        "block",
        &[with("Core::MatrixBlockGet", &corner, of_counted)],
        &[matrix([[5.0, 6.0], [8.0, 9.0]])],
    );
    let rows = with(
        "Core::MatrixArrayGet",
        &[("StartCol", 1), ("BlockWidth", 2), ("Size", 3)],
        of_counted,
    );
    same("rows", &[rows], &[array(&[2.0, 3.0, 5.0])]);
    let set = with(
        "Core::MatrixSet",
        &[("Row", 0), ("Col", 2)],
        &[counted.clone(), value_of(-1.0)],
    );
    same(
        "set",
        &[set],
        &[matrix([[1.0, 2.0, -1.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]])],
    );
    let filled = with(
        "Core::MatrixArraySet",
        &[("StartRow", 1), ("BlockWidth", 2)],
        &[counted.clone(), array(&[0.1, 0.2, 0.3])],
    );
    same(
        "filled",
        &[filled],
        &[matrix([[1.0, 2.0, 3.0], [0.1, 0.2, 6.0], [0.3, 8.0, 9.0]])],
    );
    check_selection(of_counted);
    same(
        "created",
        &[with("Core::MatrixCreate", &[("Rows", 2), ("Cols", 1)], &[])],
        &[matrix([[0.0], [0.0]])],
    );
}

#[test]
fn slices_of_arrays() {
    let three = array(&[1.0, 2.0, 3.0]);
    same(
        "slice",
        &[with(
            "Core::DoubleArraySlice",
            &[("Size", 2), ("Start", 1)],
            std::slice::from_ref(&three),
        )],
        &[array(&[2.0, 3.0])],
    );
    same(
        "get",
        &[with("Core::DoubleArrayGet", &[("Index", 2)], &[three])],
        &[value_of(3.0)],
    );
}

#[test]
fn indices_outside_are_refused_when_sizes_are_known() {
    use rpi_image::ShapeArgs;
    let cases: [(&str, &[(&str, i64)]); 6] = [
        ("Core::DoubleArrayGet", &[("Index", 3)]),
        ("Core::DoubleArraySet", &[("Index", -1)]),
        ("Core::DoubleArraySlice", &[("Size", 2), ("Start", 2)]),
        ("Core::MatrixGet", &[("Row", 3)]),
        (
            "Core::MatrixBlockGet",
            &[("StartCol", 2), ("BlockWidth", 2)],
        ),
        ("Core::MatrixArrayGet", &[("Size", 4)]),
    ];
    for (name, given) in cases {
        let desc = rpi_prims::PrimId::from_name(name)
            .expect("registered")
            .desc();
        let params = desc.params.iter().map(|p| {
            let value = given
                .iter()
                .find(|(name, _)| *name == p.name)
                .map(|(_, v)| value_of(*v));
            value.unwrap_or_else(|| {
                p.default
                    .value(Type::Scalar(Scalar::Int))
                    .expect("a default")
            })
        });
        let params: Vec<Value> = params.collect();
        let input = if name.contains("Matrix") {
            Type::Matrix(3, 3)
        } else {
            Type::Array(Scalar::Real, 3)
        };
        let args = ShapeArgs {
            inputs: &[Some(input), Some(Type::Scalar(Scalar::Real))],
            params: &params,
        };
        assert_eq!(desc.out_type(0, &args), None, "{name}");
    }
}

fn bits(text: &str) -> Value {
    array(&text.bytes().map(|b| b == b'1').collect::<Vec<_>>())
}

#[test]
fn numbers_as_bits_lowest_first() {
    let dec = |name: &str, n: i64, signed: bool, value: i64| {
        let params = [("amountBits", value_of(n)), ("signBit", value_of(signed))];
        TestBench::new(name, &params).step_present(&[value_of(value)])
    };
    assert_eq!(
        dec("Core::DecToBin", 4, false, 6),
        [bits("0110"), value_of(false)]
    );
    assert_eq!(dec("Core::DecToBin", 4, false, 16)[1], value_of(true));
    assert_eq!(
        dec("Core::DecToBin", 4, true, -2),
        [bits("0111"), value_of(false)]
    );
    assert_eq!(dec("Core::DecToBin", 4, true, 8)[1], value_of(true));
    assert_eq!(
        dec("Core::DecToBCD", 8, false, 42),
        [bits("01000010"), value_of(false)]
    );
    assert_eq!(
        dec("Core::DecToBCD", 9, true, -42),
        [bits("010000101"), value_of(false)]
    );
    assert_eq!(dec("Core::DecToBCD", 8, false, 142)[1], value_of(true));
    assert_eq!(dec("Core::DecToBCD", 8, false, -4)[1], value_of(true));
    let number = |name: &str, text: &str, signed: bool| {
        let mut rig = TestBench::new(
            name,
            &[
                ("amountBits", value_of(3_i64)),
                ("signBit", value_of(signed)),
            ],
        );
        (get::<i64>(&rig.step_present(&[bits(text)])[0]), rig.fault)
    };
    assert_eq!(number("Core::BinToDec", "011", false), (6, None));
    assert_eq!(number("Core::BinToDec", "011", true), (-2, None));
    assert_eq!(number("Core::BCDToDec", "101", false), (5, None));
    assert_eq!(number("Core::BCDToDec", "101", true), (-1, None));
}
