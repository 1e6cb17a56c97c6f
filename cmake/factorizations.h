// Eigen's dense factorizations of matrices of any size, compiled once for all folders (factorizations.cpp): each
// takes a compiler 3 to 12 s in every unit that computes it. Code that uses them is the same with this header and without.
// A factorization or a solution of an expression, or into one, is another function: give it a name first.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

#ifndef ABBE_ONCE
#define ABBE_ONCE extern
#endif

namespace Eigen {

ABBE_ONCE template class LLT<MatrixXd>;
ABBE_ONCE template LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
ABBE_ONCE template void LLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
ABBE_ONCE template void LLT<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;

ABBE_ONCE template class LDLT<MatrixXd>;
ABBE_ONCE template LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
ABBE_ONCE template void LDLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
ABBE_ONCE template void LDLT<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;

ABBE_ONCE template class PartialPivLU<MatrixXd>;
ABBE_ONCE template PartialPivLU<MatrixXd>& PartialPivLU<MatrixXd>::compute(
    const EigenBase<MatrixXd>&);

ABBE_ONCE template class HouseholderQR<MatrixXd>;
ABBE_ONCE template void HouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;

ABBE_ONCE template class ColPivHouseholderQR<MatrixXd>;
ABBE_ONCE template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&,
                                                                   VectorXd&) const;
ABBE_ONCE template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const MatrixXd&,
                                                                   MatrixXd&) const;

ABBE_ONCE template class CompleteOrthogonalDecomposition<MatrixXd>;
ABBE_ONCE template void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const Vector3d&,
                                                                               VectorXd&) const;
ABBE_ONCE template void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const VectorXd&,
                                                                               VectorXd&) const;
ABBE_ONCE template void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const MatrixXd&,
                                                                               MatrixXd&) const;
ABBE_ONCE template void
CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(  // the pseudo-inverse
    const MatrixXd::IdentityReturnType&, MatrixXd&) const;

ABBE_ONCE template class SelfAdjointEigenSolver<MatrixXd>;
ABBE_ONCE template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);

ABBE_ONCE template class JacobiSVD<MatrixXd>;

}  // namespace Eigen
