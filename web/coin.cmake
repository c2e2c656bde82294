# SPDX-License-Identifier: Apache-2.0
# CBC and what it is made of, from Debian's sources, without their configure scripts: those look for
# libraries of a machine, of which there are none here.
set(utils ${STARGUARD_SOURCES}/coinutils/CoinUtils/src)
set(osi ${STARGUARD_SOURCES}/coinor-osi/Osi/src/Osi)
set(clp ${STARGUARD_SOURCES}/clp/Clp/src)
set(cgl ${STARGUARD_SOURCES}/coinor-cgl/Cgl/src)
set(cbc ${STARGUARD_SOURCES}/coinor-cbc/Cbc/src)

file(GLOB sources ${utils}/*.cpp ${osi}/*.cpp ${clp}/*.cpp ${clp}/OsiClp/*.cpp ${cgl}/*.cpp
    ${cgl}/*/*.cpp ${cbc}/*.cpp)
# Left out: programs, tests, the parallel simplex method, interfaces to other libraries, and what
# CbcCbcParam.cpp includes as a whole.
set(unwanted
    ClpMain CoinSolve ClpSolver Clp_ampl CbcOrClpParam "My[A-Z].*" "CbcGen[A-Z].*" CbcGeneric
    "[A-Za-z0-9]+Test"
    "Abc.*" "CoinAbc.*"
    "ClpCholesky(Mumps|Pardiso|Taucs|Ufl|Wssmp.*)")
list(JOIN unwanted "|" unwanted)
list(FILTER sources EXCLUDE REGEX "/(${unwanted})\\.cpp$")
file(GLOB folders LIST_DIRECTORIES true ${cgl}/*)
list(FILTER folders EXCLUDE REGEX "\\.[a-z]+$")

add_library(coin STATIC ${sources})
target_include_directories(coin SYSTEM PUBLIC ${utils} ${osi} ${clp} ${clp}/OsiClp ${cgl} ${folders} ${cbc})
target_compile_definitions(coin PRIVATE COIN_HAS_CGL COIN_HAS_CLP COIN_HAS_COINUTILS COIN_HAS_OSI
    HAVE_CMATH HAVE_CFLOAT)
target_compile_options(coin PRIVATE -std=c++14 -O2 -w -fwasm-exceptions)
