//! Tests with small problems whose answers are known from an exhaustive search.

use super::*;

/// Pseudo-random number generator SplitMix64 (Steele et al. 2014).
struct Random(u64);

impl Random {
    fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % bound
    }
}

/// Disjunct of a clause: a comparison `sum of factors * x + constant <= 0`, or a Boolean. The last field says whether
/// it must hold.
#[derive(Clone, Debug)]
enum Disjunct {
    Boolean(usize, bool),
    AtMostZero([i64; 3], i64, bool),
}

const BOOLEANS: usize = 4;
const LOW: i64 = -3;
const HIGH: i64 = 3;

fn part(random: &mut Random) -> Disjunct {
    let holds = random.below(2) == 0;
    if random.below(3) == 0 {
        return Disjunct::Boolean(random.below(BOOLEANS as u64) as usize, holds);
    }
    let factors = [0; 3].map(|_: i64| random.below(5) as i64 - 2);
    Disjunct::AtMostZero(factors, random.below(9) as i64 - 4, holds)
}

fn holds(part: &Disjunct, booleans: u64, integers: [i64; 3]) -> bool {
    match part {
        Disjunct::Boolean(at, polarity) => (booleans >> at & 1 == 1) == *polarity,
        Disjunct::AtMostZero(factors, constant, polarity) => {
            let sum: i64 = (0..3).map(|k| factors[k] * integers[k]).sum();
            (sum + constant <= 0) == *polarity
        }
    }
}

fn has_solution(clauses: &[Vec<Disjunct>]) -> bool {
    let all = LOW..=HIGH;
    let triples = all.clone().flat_map(|x| {
        let all = all.clone();
        let pairs = all
            .clone()
            .flat_map(move |y| all.clone().map(move |z| (y, z)));
        pairs.map(move |(y, z)| [x, y, z])
    });
    let satisfies = |booleans: u64, integers: [i64; 3]| {
        let mut clauses = clauses.iter();
        clauses.all(|clause| clause.iter().any(|part| holds(part, booleans, integers)))
    };
    triples
        .into_iter()
        .any(|integers| (0..1 << BOOLEANS).any(|booleans| satisfies(booleans, integers)))
}

#[test]
fn answers_agree_with_a_search_of_all_assignments() {
    let mut random = Random(24);
    let mut answers = [0; 2];
    for round in 0..400 {
        let count = 2 + random.below(14);
        let clauses: Vec<Vec<Disjunct>> = (0..count)
            .map(|_| (0..=random.below(3)).map(|_| part(&mut random)).collect())
            .collect();
        let mut solver = Solver::new();
        let booleans: Vec<Lit> = (0..BOOLEANS).map(|_| solver.new_bool()).collect();
        let integers = [0; 3].map(|_| solver.integer(LOW, HIGH));
        for clause in &clauses {
            let lits: Vec<Lit> = clause
                .iter()
                .map(|part| match part {
                    Disjunct::Boolean(at, true) => booleans[*at],
                    Disjunct::Boolean(at, false) => !booleans[*at],
                    Disjunct::AtMostZero(factors, constant, polarity) => {
                        let terms = (0..3).map(|k| (integers[k], factors[k]));
                        let sum = LinearTerm {
                            terms: terms.filter(|(_, f)| *f != 0).collect(),
                            constant: *constant,
                        };
                        let lit = solver.at_most_zero(&sum);
                        if *polarity { lit } else { !lit }
                    }
                })
                .collect();
            solver.add_clause(&lits);
        }
        let mut steps = 1_000_000;
        let answer = solver.solve(&[], &mut steps);
        let expected = match has_solution(&clauses) {
            true => SatResult::Sat,
            false => SatResult::Unsat,
        };
        assert_eq!(answer, expected, "round {round}: {clauses:?}");
        answers[usize::from(expected == SatResult::Sat)] += 1;
    }
    assert!(answers[0] > 50 && answers[1] > 50, "{answers:?}");
}

#[test]
fn assumptions_hold_for_one_question_only() {
    let mut solver = Solver::new();
    let (a, b) = (solver.new_bool(), solver.new_bool());
    let both = solver.and(a, b);
    solver.add_clause(&[!both]);
    let mut steps = 1_000;
    assert_eq!(solver.solve(&[a, b], &mut steps), SatResult::Unsat);
    assert_eq!(solver.solve(&[a], &mut steps), SatResult::Sat);
    assert_eq!(solver.value(b), Some(false));
}

#[test]
fn remainders_that_exclude_each_other_are_refuted() {
    let mut solver = Solver::new();
    let limits = (i64::MIN / 2, i64::MAX / 2);
    let [n, q, p] = [0; 3].map(|_| solver.integer(limits.0, limits.1));
    // n - 6 q = 0 and n - 3 p = 1
    for (terms, constant) in [(vec![(n, 1), (q, -6)], 0), (vec![(n, 1), (p, -3)], -1)] {
        let negated = terms.iter().map(|(v, f)| (*v, -f)).collect();
        let above = LinearTerm { terms, constant };
        let below = LinearTerm {
            terms: negated,
            constant: -constant,
        };
        for sum in [above, below] {
            let lit = solver.at_most_zero(&sum);
            solver.add_clause(&[lit]);
        }
    }
    assert_eq!(solver.solve(&[], &mut 100_000), SatResult::Unsat);
}

/// Comparisons that are not required have factors that overflow. They must not refute anything.
#[test]
fn what_does_not_fit_refutes_nothing() {
    let mut random = Random(41);
    let mut found = [0; 2];
    for round in 0..300 {
        let mut solver = Solver::new();
        let small = [0; 3].map(|_| solver.integer(LOW, HIGH));
        let large = [0; 3].map(|_| solver.integer(i64::MIN, i64::MAX));
        let mut lits = Vec::new();
        for _ in 0..8 {
            let mut terms: Vec<(usize, i64)> = Vec::new();
            for variable in small.iter().chain(&large) {
                let factor = (random.below(u64::MAX) >> random.below(60)) as i64;
                terms.extend((random.below(2) == 0 && factor != 0).then_some((*variable, factor)));
            }
            let constant = (random.below(u64::MAX) >> 20) as i64;
            lits.push(solver.at_most_zero(&LinearTerm { terms, constant }));
        }
        let mut clauses = Vec::new();
        for _ in 0..3 {
            // Assume two of the large comparisons first, then ask about small integers.
            let assumptions = [0; 2].map(|_| lits[random.below(lits.len() as u64) as usize]);
            solver.solve(&assumptions, &mut 100_000);
            clauses.push(vec![small_comparison(&mut random)]);
            let Some(Disjunct::AtMostZero(factors, constant, polarity)) =
                clauses.last().map(|c| c[0].clone())
            else {
                continue;
            };
            let terms = (0..3)
                .map(|k| (small[k], factors[k]))
                .filter(|(_, f)| *f != 0)
                .collect();
            let lit = solver.at_most_zero(&LinearTerm { terms, constant });
            solver.add_clause(&[if polarity { lit } else { !lit }]);
            let answer = solver.solve(&[], &mut 100_000);
            let is_solvable = has_solution(&clauses);
            assert!(
                !is_solvable || answer != SatResult::Unsat,
                "round {round}: {clauses:?}"
            );
            found[usize::from(is_solvable)] += 1;
        }
    }
    assert!(found[0] > 50 && found[1] > 50, "{found:?}");
}

fn small_comparison(random: &mut Random) -> Disjunct {
    let factors = [0; 3].map(|_: i64| random.below(5) as i64 - 2);
    Disjunct::AtMostZero(factors, random.below(9) as i64 - 4, random.below(2) == 0)
}
