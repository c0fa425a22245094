// The anchored frame, moved = rest + B pull, in the forms in which Eigen may be asked for it.
#include <Eigen/Dense>
#include <chrono>

namespace
{
using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ColumnMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic>;
using Rows3 = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Columns3 = Eigen::Matrix<float, Eigen::Dynamic, 3>;
using Rows10 = Eigen::Matrix<float, Eigen::Dynamic, 10, Eigen::RowMajor>;
using Columns10 = Eigen::Matrix<float, Eigen::Dynamic, 10>;

template <class Work> double least_ns(unsigned rounds, Work work)
{
    double least = 1e30;
    for (unsigned i = 0; i < rounds; ++i) {
        auto start = std::chrono::steady_clock::now();
        work();
        std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
        least = std::min(least, took.count());
    }
    return least;
}

template <class Basis, class Points>
double form_ns(const float *rest, const float *response, const float *pull, unsigned count,
               unsigned rounds)
{
    Basis basis = Eigen::Map<const RowMajor>(response, count, 10);
    Points from = Eigen::Map<const RowMajor>(rest, count, 3);
    Eigen::Matrix<float, 10, 3> by =
        Eigen::Map<const Eigen::Matrix<float, 10, 3, Eigen::RowMajor>>(pull);
    Points to(count, 3);
    return least_ns(rounds, [&] {
        to.noalias() = from;
        to.noalias() += basis * by;
    });
}

template <class Basis, class Points>
double lazy_ns(const float *rest, const float *response, const float *pull, unsigned count,
               unsigned rounds)
{
    Basis basis = Eigen::Map<const RowMajor>(response, count, 10);
    Points from = Eigen::Map<const RowMajor>(rest, count, 3);
    Eigen::Matrix<float, 10, 3> by =
        Eigen::Map<const Eigen::Matrix<float, 10, 3, Eigen::RowMajor>>(pull);
    Points to(count, 3);
    return least_ns(rounds, [&] { to = from + basis.lazyProduct(by); });
}
} // namespace

// out: 6 forms.
extern "C" __attribute__((visibility("default"))) void
eigen_forms_ns(const float *rest, const float *response, const float *pull, unsigned count,
               unsigned rounds, double out[6])
{
    out[0] = form_ns<ColumnMajor, Columns3>(rest, response, pull, count, rounds);
    out[1] = form_ns<RowMajor, Rows3>(rest, response, pull, count, rounds);
    out[2] = form_ns<Columns10, Columns3>(rest, response, pull, count, rounds);
    out[3] = form_ns<Rows10, Rows3>(rest, response, pull, count, rounds);
    out[4] = lazy_ns<Columns10, Columns3>(rest, response, pull, count, rounds);
    out[5] = lazy_ns<Rows10, Rows3>(rest, response, pull, count, rounds);
}
