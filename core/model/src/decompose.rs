//! Decompositions of matrices that always end.
//!
//! nalgebra's own go on until they converge, which with a number that is not finite, or whose square
//! is not, is never; and nothing can cancel them. These look at the numbers first, count their
//! iterations, and have no answer where there is none. Their answers are nalgebra's, bit for bit.

use nalgebra::allocator::Allocator;
use nalgebra::{
    DefaultAllocator, Dim, DimDiff, DimMin, DimMinimum, DimSub, Matrix3, OMatrix, OVector, SVD,
    SymmetricEigen, U1,
};

/// Larger numbers have no place in a decomposition: the square of their square is not finite.
const LARGEST: f64 = 1e75;
/// Iterations per row that are granted. Two or three are usual.
const PER_ROW: usize = 200;

/// Singular values, the largest first, with the vectors that are asked for; `None` for an empty
/// matrix, for numbers that are not finite or beyond all measure, and where it does not converge.
pub fn svd<R: DimMin<C>, C: Dim>(
    matrix: OMatrix<f64, R, C>,
    compute_u: bool,
    compute_v: bool,
) -> Option<SVD<f64, R, C>>
where
    DimMinimum<R, C>: DimSub<U1>,
    DefaultAllocator: Allocator<R, C>
        + Allocator<C>
        + Allocator<R>
        + Allocator<DimDiff<DimMinimum<R, C>, U1>>
        + Allocator<DimMinimum<R, C>, C>
        + Allocator<R, DimMinimum<R, C>>
        + Allocator<DimMinimum<R, C>>,
{
    let limit = limit_for(&matrix)?;
    SVD::try_new(matrix, compute_u, compute_v, 5.0 * f64::EPSILON, limit)
}

/// Singular values, the largest first; `None` as in [`svd`].
pub fn singular_values<R: DimMin<C>, C: Dim>(
    matrix: OMatrix<f64, R, C>,
) -> Option<OVector<f64, DimMinimum<R, C>>>
where
    DimMinimum<R, C>: DimSub<U1>,
    DefaultAllocator: Allocator<R, C>
        + Allocator<C>
        + Allocator<R>
        + Allocator<DimDiff<DimMinimum<R, C>, U1>>
        + Allocator<DimMinimum<R, C>, C>
        + Allocator<R, DimMinimum<R, C>>
        + Allocator<DimMinimum<R, C>>,
{
    svd(matrix, false, false).map(|found| found.singular_values)
}

/// How many singular values are above `eps`; `None` as in [`svd`].
pub fn rank<R: DimMin<C>, C: Dim>(matrix: OMatrix<f64, R, C>, eps: f64) -> Option<usize>
where
    DimMinimum<R, C>: DimSub<U1>,
    DefaultAllocator: Allocator<R, C>
        + Allocator<C>
        + Allocator<R>
        + Allocator<DimDiff<DimMinimum<R, C>, U1>>
        + Allocator<DimMinimum<R, C>, C>
        + Allocator<R, DimMinimum<R, C>>
        + Allocator<DimMinimum<R, C>>,
{
    singular_values(matrix).map(|values| values.iter().filter(|value| **value > eps).count())
}

/// Moore–Penrose inverse; singular values up to `eps` count as zero. `None` as in [`svd`].
pub fn pseudo_inverse<R: DimMin<C>, C: Dim>(
    matrix: OMatrix<f64, R, C>,
    eps: f64,
) -> Option<OMatrix<f64, C, R>>
where
    DimMinimum<R, C>: DimSub<U1>,
    DefaultAllocator: Allocator<R, C>
        + Allocator<C, R>
        + Allocator<C>
        + Allocator<R>
        + Allocator<DimDiff<DimMinimum<R, C>, U1>>
        + Allocator<DimMinimum<R, C>, C>
        + Allocator<R, DimMinimum<R, C>>
        + Allocator<DimMinimum<R, C>>,
{
    let limit = limit_for(&matrix)?;
    let found = SVD::try_new_unordered(matrix, true, true, 5.0 * f64::EPSILON, limit)?;
    found.pseudo_inverse(eps).ok()
}

/// Eigenvalues in no order, and eigenvectors, of a symmetric matrix, of which only the lower triangle
/// is read; `None` for an empty matrix, for numbers that are not finite or beyond all measure, and
/// where it does not converge.
pub fn symmetric_eigen<D: Dim + DimSub<U1>>(matrix: OMatrix<f64, D, D>) -> Option<SymmetricEigen<f64, D>>
where
    DefaultAllocator: Allocator<D, D> + Allocator<D> + Allocator<DimDiff<D, U1>>,
{
    let rows = usable_rows(&matrix)?;
    SymmetricEigen::try_new(matrix, f64::EPSILON, PER_ROW * (rows + 1))
}

/// Eigenvalues in no order of a symmetric matrix; `None` as in [`symmetric_eigen`].
pub fn symmetric_eigenvalues<D: Dim + DimSub<U1>>(matrix: OMatrix<f64, D, D>) -> Option<OVector<f64, D>>
where
    DefaultAllocator: Allocator<D, D> + Allocator<D> + Allocator<DimDiff<D, U1>>,
{
    symmetric_eigen(matrix).map(|found| found.eigenvalues)
}

/// Number of rows of a matrix that can be taken apart.
fn usable_rows<R: Dim, C: Dim>(matrix: &OMatrix<f64, R, C>) -> Option<usize>
where
    DefaultAllocator: Allocator<R, C>,
{
    // Not so for NaN either.
    (!matrix.is_empty() && matrix.iter().all(|value| value.abs() <= LARGEST)).then(|| matrix.nrows())
}

/// Iterations granted to a singular value decomposition; 0 stands for no limit.
fn limit_for<R: Dim, C: Dim>(matrix: &OMatrix<f64, R, C>) -> Option<usize>
where
    DefaultAllocator: Allocator<R, C>,
{
    let rows = usable_rows(matrix)?;
    if (R::try_to_usize(), C::try_to_usize()) != (Some(3), Some(3)) {
        return Some(PER_ROW * (rows.min(matrix.ncols()) + 1));
    }
    // nalgebra takes 3 × 3 apart in a way of its own, which must not be stopped (0.35 takes "not
    // found" for an answer). It rests on the eigenvectors of this product, found in the same steps:
    // when these end, so does that.
    let at = |row, column| matrix[(row, column)];
    let own = Matrix3::new(
        at(0, 0),
        at(0, 1),
        at(0, 2),
        at(1, 0),
        at(1, 1),
        at(1, 2),
        at(2, 0),
        at(2, 1),
        at(2, 2),
    );
    SymmetricEigen::try_new(own.tr_mul(&own), 5.0 * f64::EPSILON, PER_ROW).map(|_| 0)
}

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "compared with what nalgebra does without a limit")]
mod tests {
    use nalgebra::{DMatrix, Matrix2, Matrix6, SMatrix};

    use super::*;

    /// Neither kind of answer can be compared as it is: their digits are.
    fn told<T: std::fmt::Debug>(found: Option<T>) -> String {
        format!("{found:?}")
    }

    /// The same numbers each time, between −1 and 1.
    fn number(i: usize, j: usize) -> f64 {
        ((i * 37 + j * 101 + i * j * 13) % 199) as f64 / 99.5 - 1.0
    }

    #[test]
    fn answers_are_those_of_nalgebra() {
        for (rows, columns) in [(1, 1), (2, 5), (7, 3), (3, 3), (40, 12)] {
            let matrix = DMatrix::from_fn(rows, columns, number);
            assert_eq!(told(svd(matrix.clone(), true, true)), told(Some(matrix.clone().svd(true, true))));
            assert_eq!(singular_values(matrix.clone()), Some(matrix.singular_values()));
            assert_eq!(rank(matrix.clone(), 1e-9), Some(matrix.rank(1e-9)));
            assert_eq!(pseudo_inverse(matrix.clone(), 1e-9), matrix.clone().pseudo_inverse(1e-9).ok());
            let square = matrix.tr_mul(&matrix);
            assert_eq!(told(symmetric_eigen(square.clone())), told(Some(square.clone().symmetric_eigen())));
            assert_eq!(symmetric_eigenvalues(square.clone()), Some(square.symmetric_eigenvalues()));
        }
        let (two, three, six) =
            (Matrix2::from_fn(number), Matrix3::from_fn(number), Matrix6::from_fn(number));
        assert_eq!(told(svd(two, true, true)), told(Some(two.svd(true, true))));
        assert_eq!(told(svd(three, true, true)), told(Some(three.svd(true, true))));
        assert_eq!(told(svd(six, true, false)), told(Some(six.svd(true, false))));
        assert_eq!(pseudo_inverse(three, 1e-9), three.pseudo_inverse(1e-9).ok());
        let narrow = SMatrix::<f64, 3, 2>::from_fn(number);
        assert_eq!(told(svd(narrow, true, true)), told(Some(narrow.svd(true, true))));
    }

    #[test]
    fn what_cannot_be_taken_apart_has_no_answer_and_an_end() {
        for wild in [f64::NAN, f64::INFINITY, -1e308, 1e200] {
            let mut matrix = DMatrix::from_fn(30, 8, number);
            matrix[(11, 5)] = wild;
            assert!(svd(matrix.clone(), true, true).is_none(), "{wild}");
            assert_eq!(pseudo_inverse(matrix.clone(), 1e-9), None, "{wild}");
            assert_eq!(rank(matrix, 1e-9), None, "{wild}");
            let mut three = Matrix3::from_fn(number);
            three[(1, 2)] = wild;
            assert!(svd(three, true, true).is_none(), "{wild}");
            three[(2, 1)] = wild;
            assert!(symmetric_eigen(three).is_none(), "{wild}");
        }
        assert!(svd(DMatrix::zeros(0, 3), true, true).is_none());
        assert_eq!(symmetric_eigenvalues(DMatrix::zeros(0, 0)), None);
    }

    #[test]
    fn zeros_and_equal_values_are_no_trouble() {
        assert_eq!(rank(DMatrix::zeros(4, 3), 1e-9), Some(0));
        assert_eq!(rank(Matrix3::identity(), 1e-9), Some(3));
        assert_eq!(symmetric_eigenvalues(Matrix3::zeros()), Some(Matrix3::zeros().column(0).into_owned()));
    }
}
