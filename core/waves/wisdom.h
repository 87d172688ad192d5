// FFTW plans ("wisdom") for 1-D transforms of 256, 512 … 16384 in single precision: up to a fifth faster than
// FFTW's estimate, and more than twice as fast from 4096 on. Another build of FFTW rejects them and
// estimates. Each is what FFTW_PATIENT finds for a line as LineTransform plans it (transform.cpp), exported alone.
#pragma once

namespace pelagic {

inline constexpr char kSingleLineWisdom[] =
    R"wisdom((fftw-3.3.10 fftwf_wisdom #x9e7d4dee #xdb14fed1 #x34bf76a4 #xeb6e8fdf
  (fftwf_codelet_t2sv_8_avx 0 #x11048 #x11048 #x0 #xde0cc236 #x4967961b #xde26ce30 #xa06d202f)
  (fftwf_codelet_n2sv_32_avx 0 #x11048 #x11048 #x0 #xb210285c #x82e55893 #xe51b864b #x4f835738)
  (fftwf_codelet_t1sv_32_avx 0 #x11048 #x11048 #x0 #xd749a4c3 #x41f90e60 #x58dcd6d8 #xb95480c2)
  (fftwf_codelet_n2sv_16_avx 0 #x11048 #x11048 #x0 #x2cb2af97 #x50334b64 #x2fd42b4c #x18ad322f)
  (fftwf_dft_vrank_geq1_register 0 #x11048 #x11048 #x0 #xe853b1f8 #xc1de0617 #xc99466bc #x7ce8c470)
  (fftwf_codelet_t2sv_8_avx 0 #x11048 #x11048 #x0 #x4c856f91 #x7aa26fe1 #xe8830982 #x8e3b8b72)
  (fftwf_codelet_t1sv_8_avx 0 #x11048 #x11048 #x0 #xbe797f6d #xcb796038 #x81bd7f65 #xe248759c)
  (fftwf_codelet_n2sv_16_avx 0 #x11048 #x11048 #x0 #x3c400587 #xed0d677a #xa71332c9 #x116925bd)
  (fftwf_codelet_t2sv_8_avx 0 #x11048 #x11048 #x0 #x2bee06e4 #x01bcd7f5 #xa45ecbf8 #xfed29174)
  (fftwf_dft_vrank_geq1_register 0 #x11048 #x11048 #x0 #x4f4bf74c #x1610256e #x3f73d8e4 #x449fc855)
  (fftwf_codelet_n2sv_32_avx 0 #x11048 #x11048 #x0 #xce6bb24d #x743170e8 #x7ebab887 #x63b4467a)
  (fftwf_codelet_t2sv_8_avx 0 #x11048 #x11048 #x0 #x90cda541 #xd57ac199 #xc17e5976 #xbc8cb2b9)
  (fftwf_codelet_n2sv_16_avx 0 #x11048 #x11048 #x0 #x9e97f98f #xa0773b0a #x9d0ce4a4 #x9407e73f)
  (fftwf_codelet_t2sv_32_avx 0 #x11048 #x11048 #x0 #x954f8ab9 #xcfb0aad0 #xbd375360 #x944568c9)
  (fftwf_dft_vrank_geq1_register 0 #x11048 #x11048 #x0 #xae7e87c1 #xe6e244b7 #x99abcfe2 #x09771c41)
  (fftwf_codelet_t1sv_8_avx 0 #x11048 #x11048 #x0 #x2f5b728d #x00f3b8a0 #x49f2aac0 #xc8033609)
  (fftwf_codelet_n2sv_16_avx 0 #x11048 #x11048 #x0 #x4b2317b6 #xb8a4f3b2 #xe7192866 #x026ab75b)
  (fftwf_codelet_t2sv_32_avx 0 #x11048 #x11048 #x0 #x23fc542c #x65921b5a #x91dbdb62 #x211b0b10)
  (fftwf_dft_vrank_geq1_register 0 #x11048 #x11048 #x0 #xabf4f124 #x07046bc2 #xae3e7a07 #xcecfcbfb)
  (fftwf_codelet_t1sv_16_avx 0 #x11048 #x11048 #x0 #xe7560fd8 #xb5f66589 #x1422b751 #xbec67d5f)
  (fftwf_codelet_t1sv_32_avx 0 #x11048 #x11048 #x0 #x3ec40c1c #x8f24afc7 #xf21a8e70 #xb9002816)
  (fftwf_dft_vrank_geq1_register 0 #x11048 #x11048 #x0 #x5446e7ef #x07579f14 #x0aaf44e1 #x19a0a8af)
  (fftwf_codelet_t2sv_4_sse2 0 #x11048 #x11048 #x0 #x8fab2467 #x12a19d5b #x1dce0d8b #x31e3c9e9)
  (fftwf_codelet_t2sv_16_avx 0 #x11048 #x11048 #x0 #xfe9fbae4 #x8dea9daa #x6354330b #x8665a045)
  (fftwf_codelet_n2sv_8_sse2 0 #x11048 #x11048 #x0 #xf926dabb #xef2a7289 #x04c97026 #xaa8e83a2)
  (fftwf_dft_vrank_geq1_register 0 #x11048 #x11048 #x0 #xf7219dc0 #xc2ee4ee6 #x8a84fbe5 #x245768d3)
)
)wisdom";

// The same for lines of pairs (LineTransform::Parts), of the lengths that vessels' tiles are shown in: 320, 400, 480, 560, 640.
inline constexpr char kPairedLineWisdom[] =
    R"wisdom((fftw-3.3.10 fftwf_wisdom #x9e7d4dee #xdb14fed1 #x34bf76a4 #xeb6e8fdf
  (fftwf_codelet_n2bv_16_avx 0 #x11048 #x11048 #x0 #x0f89a429 #xd5be9fda #x3c36f263 #x47686d63)
  (fftwf_codelet_t2bv_20_avx 0 #x11048 #x11048 #x0 #x26b22518 #x27332121 #xd0851861 #xfcfc16ca)
  (fftwf_codelet_t2bv_20_avx 0 #x11048 #x11048 #x0 #x3da58366 #xb7d6a2da #x437dcc99 #x7c166232)
  (fftwf_codelet_n2bv_20_avx 0 #x11048 #x11048 #x0 #x3d74e141 #xaea1c54b #xa5186d81 #x49e4369e)
  (fftwf_codelet_n2bv_12_avx 0 #x11048 #x11048 #x0 #xb0282c2f #x13d43c0f #x2a02806d #xb69d5c33)
  (fftwf_codelet_t2bv_5_avx 0 #x11048 #x11048 #x0 #x2d627ed4 #xce312406 #xd515829b #x32e795dd)
  (fftwf_dft_vrank_geq1_register 0 #x11048 #x11048 #x0 #x2ce50037 #x58405cc2 #xfd5fbcd1 #x52587115)
  (fftwf_codelet_t2bv_8_avx 0 #x11048 #x11048 #x0 #xe4832ac3 #xa58b7846 #x8641b180 #x22ee16b8)
  (fftwf_codelet_n2bv_4_avx 0 #x11048 #x11048 #x0 #xb83c4b15 #x57878487 #xc5c2dcbf #xab3ef18e)
  (fftwf_dft_vrank_geq1_register 0 #x11048 #x11048 #x0 #x98842cdb #xe66fad27 #x7b8400d9 #x81aea171)
  (fftwf_codelet_t1bv_7_avx 0 #x11048 #x11048 #x0 #x0f430d26 #xc83d2ad9 #x73d80f72 #xe72b93ab)
  (fftwf_codelet_t2bv_20_avx 0 #x11048 #x11048 #x0 #x8e292a89 #xb7544841 #x28be0a5f #x9e8b284c)
  (fftwf_codelet_n2bv_20_avx 0 #x11048 #x11048 #x0 #x392985b4 #xf4275012 #xd0a70c00 #x40713784)
  (fftwf_codelet_t2bv_32_avx 0 #x11048 #x11048 #x0 #xd0940e0e #xc72734f1 #xef0bbd22 #x620052fc)
)
)wisdom";

}  // namespace pelagic
