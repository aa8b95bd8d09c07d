/* bench/clouds.hpp: the clouds that speed is measured on, in random order of rows. */
#ifndef PLANTIMETER_BENCH_CLOUDS_HPP
#define PLANTIMETER_BENCH_CLOUDS_HPP

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace bench
{

using Cloud = std::vector<std::array<float, 3>>;

class Random
{
  public:
    explicit Random(uint64_t seed) : state(seed) {}
    double uniform()
    {
        uint64_t z = (state += 0x9e3779b97f4a7c15u);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
    double normal()
    {
        return std::sqrt(-2 * std::log(1 - uniform())) * std::cos(6.283185307179586 * uniform());
    }

  private:
    uint64_t state;
};

/** A plant in metres: 60 curved leaves of 4 to 8 cm on a stem, scanned with 0.3 mm noise. */
inline Cloud plant(size_t count)
{
    struct Leaf {
        double centre[3], heading, tilt, radius;
    };
    Random random(7);
    std::vector<Leaf> leaves(60);
    for (Leaf &leaf : leaves)
        leaf = {{0.4 * random.uniform(), 0.4 * random.uniform(), 0.6 * random.uniform()},
                6.283185 * random.uniform(),
                1.2 * random.uniform(),
                0.04 + 0.04 * random.uniform()};
    Cloud cloud(count);
    for (auto &point : cloud) {
        const double noise = 0.0003 * random.normal(), turn = 6.283185 * random.uniform();
        double p[3];
        if (random.uniform() < 0.05) {
            p[0] = 0.2 + (0.004 + noise) * std::cos(turn);
            p[1] = 0.2 + (0.004 + noise) * std::sin(turn);
            p[2] = 0.6 * random.uniform();
        } else {
            const Leaf &leaf = leaves[static_cast<size_t>(random.uniform() * 60)];
            const double reach = leaf.radius * std::sqrt(random.uniform());
            const double u = reach * std::cos(turn), v = 0.6 * reach * std::sin(turn), w = 3 * u * u + noise;
            const double x = u * std::cos(leaf.tilt) + w * std::sin(leaf.tilt);
            p[0] = leaf.centre[0] + x * std::cos(leaf.heading) - v * std::sin(leaf.heading);
            p[1] = leaf.centre[1] + x * std::sin(leaf.heading) + v * std::cos(leaf.heading);
            p[2] = leaf.centre[2] - u * std::sin(leaf.tilt) + w * std::cos(leaf.tilt);
        }
        for (int axis = 0; axis < 3; axis++) point[axis] = static_cast<float>(p[axis]);
    }
    return cloud;
}

/** Uniform in a box of one metre. */
inline Cloud box(size_t count)
{
    Random random(8);
    Cloud cloud(count);
    for (auto &point : cloud)
        for (float &x : point) x = static_cast<float>(random.uniform());
    return cloud;
}

/** Two boxes side by side, one 30 times as dense as the other. */
inline Cloud two_densities(size_t count)
{
    Random random(9);
    Cloud cloud(count);
    for (auto &point : cloud) {
        for (float &x : point) x = static_cast<float>(random.uniform());
        if (random.uniform() < 30.0 / 31) point[0] += 1;
    }
    return cloud;
}

/** Uniform in a ball. */
inline Cloud ball(size_t count)
{
    Random random(10);
    Cloud cloud(count);
    for (auto &point : cloud) {
        const double x = random.normal(), y = random.normal(), z = random.normal();
        const double scale = std::cbrt(random.uniform()) / std::sqrt(x * x + y * y + z * z);
        point = {static_cast<float>(x * scale), static_cast<float>(y * scale), static_cast<float>(z * scale)};
    }
    return cloud;
}

} // namespace bench

#endif
