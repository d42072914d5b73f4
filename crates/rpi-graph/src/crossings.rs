//! Number of crossings of lines between adjacent layers.
//!
//! Barth, Mutzel and Jünger, "Simple and efficient bilayer cross counting", 2004: inversions, counted by a tree of sums.

use crate::layering::Place;

/// Returns the number of pairs of lines that cross between adjacent layers. `right` has the neighbours of each vertex in the layer to
/// its right.
pub(crate) fn crossings(columns: &[Vec<usize>], right: &[Vec<usize>], place: &[Place]) -> usize {
    let mut count = 0;
    for (layer, pair) in columns.windows(2).enumerate() {
        let mut sums = Sums::new(pair[1].len());
        let mut lines = 0;
        let mut ends = Vec::new();
        for vertex in &pair[0] {
            ends.clear();
            let neighbours = right[*vertex].iter().map(|other| place[*other]);
            let next = neighbours.filter(|place| place.layer == layer + 1);
            ends.extend(next.map(|place| place.position));
            // Lines that begin at the same vertex do not cross: they are counted before they are added.
            for end in &ends {
                count += lines - sums.up_to(*end);
            }
            for end in &ends {
                sums.add(*end);
            }
            lines += ends.len();
        }
    }
    count
}

/// Numbers of lines by their end, with sums over a prefix in logarithmic time (Fenwick, 1994).
struct Sums(Vec<usize>);

impl Sums {
    fn new(len: usize) -> Sums {
        Sums(vec![0; len + 1])
    }

    fn add(&mut self, at: usize) {
        let mut k = at + 1;
        while let Some(sum) = self.0.get_mut(k) {
            *sum += 1;
            k += k & k.wrapping_neg();
        }
    }

    /// Returns the number of lines that end at `at` or above.
    fn up_to(&self, at: usize) -> usize {
        let (mut k, mut sum) = (at + 1, 0);
        while k > 0 {
            sum += self.0[k];
            k -= k & k.wrapping_neg();
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_is_that_of_all_pairs() {
        // Two layers of seven and five vertices, and lines by a linear congruence.
        let columns = [(0..7).collect::<Vec<usize>>(), (7..12).collect()];
        let place: Vec<Place> = (0..12)
            .map(|v| Place {
                layer: usize::from(v >= 7),
                position: if v < 7 { v } else { v - 7 },
            })
            .collect();
        let lines: Vec<(usize, usize)> = (0..15).map(|k| (k * 5 % 7, k * 3 % 5)).collect();
        let mut right = vec![Vec::new(); 12];
        for (from, to) in &lines {
            right[*from].push(to + 7);
        }
        let crosses = |a: &(usize, usize), b: &(usize, usize)| a.0 < b.0 && a.1 > b.1;
        let pairs = lines.iter().flat_map(|a| lines.iter().map(move |b| (a, b)));
        let expected = pairs.filter(|(a, b)| crosses(a, b)).count();
        assert!(expected > 10);
        assert_eq!(crossings(&columns, &right, &place), expected);
    }
}
