//! Ranges, means and standard deviations, as the layout wants them of every feature.

use serde_json::{Value, json};

/// Of numbers that come row by row, all rows of one length.
#[derive(Clone, Debug, Default)]
pub(crate) struct Statistics {
    count: u64,
    /// Least, most, sum, sum of squares of each number.
    each: Vec<[f64; 4]>,
}

impl Statistics {
    /// A row more.
    pub fn add(&mut self, row: impl IntoIterator<Item = f64>) {
        self.count += 1;
        for (k, value) in row.into_iter().enumerate() {
            if k == self.each.len() {
                self.each.push([f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0]);
            }
            let [least, most, sum, squares] = &mut self.each[k];
            (*least, *most) = (least.min(value), most.max(value));
            (*sum, *squares) = (*sum + value, *squares + value * value);
        }
    }

    /// As it stands in the file; `shaped` says how a number stands there.
    pub fn json(&self, shaped: impl Fn(f64) -> Value) -> Value {
        let count = self.count.max(1) as f64;
        let of = |value: fn(&[f64; 4], f64) -> f64| -> Vec<Value> {
            self.each.iter().map(|each| shaped(value(each, count))).collect()
        };
        json!({
            "min": of(|[least, ..], _| *least),
            "max": of(|[_, most, ..], _| *most),
            "mean": of(|[_, _, sum, _], count| sum / count),
            "std": of(|[_, _, sum, squares], count| {
                (squares / count - (sum / count).powi(2)).max(0.0).sqrt()
            }),
            "count": [self.count],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_those_of_the_rows() {
        let mut statistics = Statistics::default();
        for (a, b) in [(1.0, -2.0), (3.0, -2.0)] {
            statistics.add([a, b]);
        }
        let told = statistics.json(|number| json!(number));
        assert_eq!(
            told,
            json!({ "min": [1.0, -2.0], "max": [3.0, -2.0], "mean": [2.0, -2.0], "std": [1.0, 0.0], "count": [2] })
        );
    }
}
