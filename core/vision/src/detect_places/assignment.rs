//! The cheapest one-to-one pairing (Kuhn's Hungarian method with potentials, O(n²m)), where
//! leaving somebody alone has a price too. Keeps its memory between calls.

/// Memory of the method.
#[derive(Debug, Default)]
pub(super) struct Assignment {
    row_potential: Vec<f64>,
    column_potential: Vec<f64>,
    /// Row that has a column, 1-based; 0 for none.
    row_of: Vec<usize>,
    way: Vec<usize>,
    least: Vec<f64>,
    used: Vec<bool>,
}

impl Assignment {
    /// Pairs `rows` with `columns` so that the sum of costs is least, where a row may stay alone
    /// for `alone`. `cost` is infinite for what must not be paired. `partner[row]` becomes its
    /// column.
    pub fn solve(
        &mut self,
        rows: usize,
        columns: usize,
        alone: f64,
        cost: impl Fn(usize, usize) -> f64,
        partner: &mut Vec<Option<usize>>,
    ) {
        partner.clear();
        partner.resize(rows, None);
        // Behind the true columns, one for every row that stays alone.
        let all = columns + rows;
        let price = |row: usize, column: usize| {
            if column < columns { cost(row, column).min(1e6 * alone) } else { alone }
        };
        for (vector, length) in [(&mut self.row_potential, rows + 1), (&mut self.column_potential, all + 1)] {
            vector.clear();
            vector.resize(length, 0.0);
        }
        self.row_of.clear();
        self.row_of.resize(all + 1, 0);
        for row in 1..=rows {
            self.add(row, all, &price);
        }
        for column in 1..=columns {
            let row = self.row_of[column];
            if row > 0 && cost(row - 1, column - 1) < alone {
                partner[row - 1] = Some(column - 1);
            }
        }
    }

    /// Adds a row along the shortest augmenting path.
    fn add(&mut self, row: usize, all: usize, price: &impl Fn(usize, usize) -> f64) {
        self.row_of[0] = row;
        self.least.clear();
        self.least.resize(all + 1, f64::INFINITY);
        self.used.clear();
        self.used.resize(all + 1, false);
        self.way.clear();
        self.way.resize(all + 1, 0);
        let mut column = 0;
        while self.row_of[column] != 0 {
            self.used[column] = true;
            let from = self.row_of[column];
            let (mut step, mut next) = (f64::INFINITY, 0);
            for j in 1..=all {
                if self.used[j] {
                    continue;
                }
                let reduced = price(from - 1, j - 1) - self.row_potential[from] - self.column_potential[j];
                if reduced < self.least[j] {
                    (self.least[j], self.way[j]) = (reduced, column);
                }
                if self.least[j] < step {
                    (step, next) = (self.least[j], j);
                }
            }
            for j in 0..=all {
                if self.used[j] {
                    self.row_potential[self.row_of[j]] += step;
                    self.column_potential[j] -= step;
                } else {
                    self.least[j] -= step;
                }
            }
            column = next;
        }
        while column != 0 {
            let before = self.way[column];
            self.row_of[column] = self.row_of[before];
            column = before;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::Noise;

    /// Cheapest total by trying everything.
    fn least(rows: &[Vec<f64>], taken: &mut Vec<usize>, row: usize, alone: f64) -> f64 {
        let Some(costs) = rows.get(row) else { return 0.0 };
        let mut best = alone + least(rows, taken, row + 1, alone);
        for (column, cost) in costs.iter().enumerate() {
            if cost.is_finite() && !taken.contains(&column) {
                taken.push(column);
                best = best.min(cost + least(rows, taken, row + 1, alone));
                taken.pop();
            }
        }
        best
    }

    #[test]
    fn nothing_is_cheaper() {
        let mut noise = Noise::new(3);
        let (mut assignment, mut partner) = (Assignment::default(), Vec::new());
        for (n, m) in [(4, 4), (1, 5), (5, 2), (6, 5), (0, 3), (3, 0)].repeat(30) {
            let mut one = || {
                let cost = noise.between(0.0, 12.0);
                if cost > 10.0 { f64::INFINITY } else { cost }
            };
            let costs: Vec<Vec<f64>> = (0..n).map(|_| (0..m).map(|_| one()).collect()).collect();
            assignment.solve(n, m, 6.0, |r, c| costs[r][c], &mut partner);
            let total: f64 = partner.iter().enumerate().map(|(r, c)| c.map_or(6.0, |c| costs[r][c])).sum();
            let truth = least(&costs, &mut Vec::new(), 0, 6.0);
            assert!((total - truth).abs() < 1e-9, "{total} instead of {truth} for {costs:?}");
            let mut columns: Vec<_> = partner.iter().flatten().collect();
            columns.sort();
            columns.dedup();
            assert_eq!(columns.len(), partner.iter().flatten().count(), "a column was given twice");
        }
    }
}
