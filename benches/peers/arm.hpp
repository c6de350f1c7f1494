// The benchmark arm in numbers, the stream of states and the least time of many batches, for all peers. The same
// numbers as crates/poinsot-dynamics/benches/xu_arm.
#pragma once
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

static const double kMass[7] = {400, 12, 10, 10, 8, 6, 30};
static const double kCentre[7][3] = {{0, 0, 0},     {0, 0, .150},    {.270, 0, -.251},  {0, 0, .150},
                                     {0, 0, -.350}, {0, -.034, 0},   {-.270, 0, .430}};
static const double kNext[6][3] = {{.357, -.010, .419}, {0, 0, .150},  {.560, 0, -.049},
                                   {0, 0, .150},        {0, 0, -.700}, {0, -.066, 0}};
// Ixx Iyy Izz Ixy Ixz Iyz about the mass centre.
static const double kInertia[7][6] = {{30, 28, 32, .260, .370, -.290}, {.510, .510, .200, 0, 0, 0},
                                      {.278, 1.811, 1.690, 0, .263, 0}, {.420, .420, .150, 0, 0, 0},
                                      {.500, .500, .210, 0, 0, 0},     {.330, .172, .260, 0, 0, 0},
                                      {2.398, 2.678, 1.405, -.069, .013, .051}};
static const double kRoll[6] = {0, 1, 0, -1, 1, -1};  // quarter turns about x

// Joint torques of the simulation: amplitude N m, frequency rad/s, phase rad; where joints and base start; joints
// after 20 s by Pinocchio 4.1.0 with steps of 0.1 ms.
static const double kTorque[6][3] = {{1.5, 4 * M_PI, 0},           {-1.2, 3 * M_PI, M_PI / 2}, {1.0, 2 * M_PI, M_PI},
                                     {.15, 2 * M_PI, 3 * M_PI / 2}, {-.1, 3 * M_PI, -M_PI / 2}, {.05, 4 * M_PI, -M_PI}};
static const double kStart[6] = {.3, -.4, .5, .2, -.7, .6};
static const double kBase[6] = {.01, .02, -.01, .02, -.03, .05};  // v, w
static const double kEnd[6] = {0.15546906886786971,  -0.067590067173427928, 0.81824186083211858,
                               -0.37213198762772542, -1.1424793121763874,   1.8384663089323137};

static double number(unsigned long long& state) {  // splitmix64, -1 to 1
  state += 0x9e3779b97f4a7c15ull;
  unsigned long long z = state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  z ^= z >> 31;
  return double(z >> 11) * (2.0 / 9007199254740992.0) - 1.0;
}

// Joint positions and rates and base velocity [v; w], all moderate.
struct State {
  double q[6], rates[6], base[6];
};

static std::vector<State> states() {
  std::vector<State> ring(64);
  unsigned long long state = 1;
  for (State& s : ring) {
    for (double& x : s.q) x = 2.0 * number(state);
    for (double& x : s.rates) x = 0.5 * number(state);
    for (double& x : s.base) x = 0.1 * number(state);
  }
  return ring;
}

// Time of this thread on the processor, s.
static double seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

// Least and median time of one call; PEER_COUNT=<name>:<calls> runs one kernel that often instead.
template <class F>
static void measure(const char* name, F call) {
  if (const char* count = std::getenv("PEER_COUNT")) {
    const char* colon = std::strrchr(count, ':');
    if (colon && std::string(count, colon) == name)
      for (long n = std::atol(colon + 1); n > 0; --n) call();
    return;
  }
  const int batches = 1000, calls = 1024;
  std::vector<double> times;
  for (int b = 0; b < batches; ++b) {
    const double start = seconds();
    for (int n = 0; n < calls; ++n) call();
    times.push_back((seconds() - start) / calls * 1e9);
  }
  std::sort(times.begin(), times.end());
  std::printf("%s,%.1f,ns_min\n%s,%.1f,ns_median\n", name, times[0], name, times[batches / 2]);
}
