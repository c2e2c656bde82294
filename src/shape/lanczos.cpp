/* SPDX-License-Identifier: Apache-2.0 */
/* Spectra is a C++ library of headers: implicitly restarted Lanczos iterations. No exception leaves
 * this file. */
#define EIGEN_NO_DEBUG /* no assertions */
#define EIGEN_MPL2_ONLY
#include "shape/lanczos.h"

#include <algorithm>
#include <exception>
#include <new>

#include <Spectra/SymEigsSolver.h>

namespace {

struct stopped : std::exception {};

class operation {
  public:
    using Scalar = double;

    explicit operation(const lanczos_problem &p) : problem(p) {
    }

    Eigen::Index rows() const {
        return static_cast<Eigen::Index>(problem.count);
    }

    Eigen::Index cols() const {
        return rows();
    }

    void perform_op(const double *x, double *y) const {
        if (!problem.apply(problem.shared, x, y))
            throw stopped();
    }

  private:
    const lanczos_problem &problem;
};

/* Fixed sizes of caches: blocks of products, and so roundings, would depend on the machine. */
bool fix_blocks() {
    Eigen::setCpuCacheSizes(32 << 10, 256 << 10, 2 << 20);
    return true;
}

} // namespace

lanczos_end lanczos_largest(const lanczos_problem *p, double *largest, double *vectors) {
    try {
        static const bool fixed = fix_blocks();
        static_cast<void>(fixed);
        operation op(*p);
        const auto wanted = static_cast<Eigen::Index>(p->wanted);
        Spectra::SymEigsSolver<operation> solver(op, wanted, static_cast<Eigen::Index>(p->kept));
        solver.init(p->start);
        solver.compute(Spectra::SortRule::LargestMagn, p->restarts, p->tolerance,
                       Spectra::SortRule::LargestAlge);
        if (solver.info() != Spectra::CompInfo::Successful)
            return LANCZOS_OPEN;
        const Eigen::VectorXd values = solver.eigenvalues();
        std::copy_n(values.data(), p->wanted, largest);
        if (vectors != nullptr) {
            const Eigen::MatrixXd columns = solver.eigenvectors(wanted);
            std::copy_n(columns.data(), p->wanted * p->count, vectors);
        }
        return LANCZOS_FOUND;
    } catch (const stopped &) {
        return LANCZOS_STOPPED;
    } catch (const std::bad_alloc &) {
        return LANCZOS_MEMORY;
    } catch (const std::exception &) { /* numbers that are not finite */
        return LANCZOS_OPEN;
    }
}
