mod nets;
use rpi_diag::FileId;
#[test]
fn scratch() {
    let all = nets::nets_in("v1").unwrap();
    let (name, text) = all.iter().find(|(n, _)| n.contains("seq-011")).unwrap();
    for _ in 0..200 { std::hint::black_box(rpi_net::rpinet::read(name, FileId(0), text)); }
}
