//! Closed forms of the inverse kinematics of tables: which of them fits.

use super::kinematics::Row;
use rpi_kin::chain::{JointType, LinkTwist};
use rpi_kin::{Convention, InverseKinematics, srs, ur};

/// Returns the closed form of the inverse kinematics that fits a Denavit-Hartenberg table in standard convention
/// without fixed transforms; `None` if none fits.
pub(super) fn of_table(
    convention: Convention,
    rows: &[Row],
    flange: &[Row],
) -> Option<InverseKinematics> {
    let is_plain = |row: &Row| {
        let link = &row.link;
        let is_own = link.sense == 1.0 && link.offset == 0.0;
        row.before.is_none() && link.joint == JointType::Revolute && is_own
    };
    if convention != Convention::Standard || !flange.is_empty() || !rows.iter().all(is_plain) {
        return None;
    }
    parallel_axes(rows).or_else(|| spherical_shoulder(rows))
}

fn twists<const N: usize>(rows: &[Row]) -> Option<[LinkTwist; N]> {
    let rows: &[Row; N] = rows.try_into().ok()?;
    Some(rows.map(|row| row.link.alpha))
}

fn are_zero(rows: &[Row], length: impl Fn(&Row) -> f64, but: &[usize]) -> bool {
    let mut all = rows.iter().enumerate();
    all.all(|(at, row)| but.contains(&at) || length(row) == 0.0)
}

/// Returns the closed form for six axes of which the second to fourth are parallel, as those of Universal Robots;
/// `None` if the table has another form.
fn parallel_axes(rows: &[Row]) -> Option<InverseKinematics> {
    const NONE: LinkTwist = LinkTwist::NONE;
    const PLUS: LinkTwist = LinkTwist::PLUS_90;
    const MINUS: LinkTwist = LinkTwist::MINUS_90;
    let fits = twists::<6>(rows)? == [PLUS, NONE, NONE, PLUS, MINUS, NONE]
        && are_zero(rows, |row| row.link.a, &[1, 2])
        && are_zero(rows, |row| row.link.d, &[0, 3, 4, 5]);
    fits.then(|| {
        InverseKinematics::Ur(ur::Geometry {
            d1: rows[0].link.d,
            a2: rows[1].link.a,
            a3: rows[2].link.a,
            d4: rows[3].link.d,
            d5: rows[4].link.d,
            d6: rows[5].link.d,
        })
    })
}

/// Returns the closed form for seven axes with spherical shoulder and wrist, as those of the KUKA LBR; `None` if the
/// table has another form.
fn spherical_shoulder(rows: &[Row]) -> Option<InverseKinematics> {
    let twists = twists::<7>(rows)?;
    let (over, back, sense) = match twists[0] {
        LinkTwist::MINUS_90 => (LinkTwist::MINUS_90, LinkTwist::PLUS_90, 1.0),
        _ => (LinkTwist::PLUS_90, LinkTwist::MINUS_90, -1.0),
    };
    let fits = twists == [over, back, back, over, over, back, LinkTwist::NONE]
        && are_zero(rows, |row| row.link.a, &[])
        && are_zero(rows, |row| row.link.d, &[0, 2, 4, 6])
        && [2, 4].iter().all(|at: &usize| rows[*at].link.d > 0.0);
    fits.then(|| {
        InverseKinematics::Srs(srs::Geometry {
            base: rows[0].link.d,
            upper: rows[2].link.d,
            fore: rows[4].link.d,
            hand: rows[6].link.d,
            sense: [1.0, sense, 1.0, -sense, 1.0, sense, 1.0],
        })
    })
}
