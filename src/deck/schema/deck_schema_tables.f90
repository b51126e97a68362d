! SPDX-License-Identifier: MIT
!> Tables of honoured keywords and their cards, in the format described in `deck_schema_m`.
module deck_schema_tables_m
  implicit none
  private
  public :: table_control, table_mesh, table_conditions, table_contact, table_database

  !> Control of the deck and of the run.
  character(119), parameter :: table_control(*) = [character(119) :: &
    'KEYWORD', &
    'END', &
    'COMMENT', &
    'TITLE o', &
    ' -:x', &
    'INCLUDE', &
    ' PATH:a80', &
    'INCLUDE_PATH', &
    ' PATH:a80', &
    'INCLUDE_TRANSFORM', &
    ' PATH:a80', &
    ' IDNOFF:i>=0 IDEOFF:i>=0 IDPOFF:i>=0 IDMOFF:i>=0 IDSOFF:i>=0 IDFOFF:i>=0 IDDOFF:i>=0', &
    ' IDROFF:i>=0 PREFIX:aw SUFFIX:aw', &
    ' FCTMAS:fr=1 FCTTIM:fr=1 FCTLEN:fr=1 FCTTEM:ar INCOUT1:iw', &
    ' TRANID:i>=0', &
    'DEFINE_TRANSFORMATION t', &
    ' TRANID:i>=1', &
    ' OPTION:a A1:f A2:f A3:f A4:f A5:f A6:f A7:f', &
    'PARAMETER o', &
    ' PRMR1:a VAL1:a PRMR2:a VAL2:a PRMR3:a VAL3:a PRMR4:a VAL4:a', &
    'PARAMETER_LOCAL o =PARAMETER', &
    'PARAMETER_EXPRESSION o', &
    ' PRMR:a EXPRESSION:a70', &
    'PARAMETER_EXPRESSION_LOCAL o =PARAMETER_EXPRESSION', &
    'PARAMETER_DUPLICATION o', &
    ' DFLAG:i=1|1|2|3|4|5', &
    'CONTROL_TERMINATION o', &
    ' ENDTIM:f>0 ENDCYC:i>=0 DTMIN:f>=0<=1 ENDENG:f>=0 ENDMAS:f>=0 NOSOL:i|0|1', &
    'TERMINATION_NODE r', &
    ' NID:i>=1 STOP:i|1|2|4 MAXC:f MINC:f', &
    'TERMINATION_BODY r', &
    ' PID:i>=1 STOP:i|1|2|4 MAXC:f MINC:f', &
    'TERMINATION_CONTACT r', &
    ' CID:i>=1 ACTIM:f>=0 DUR:f>=0 THRES:f>=0 DOF:i|0|1|2', &
    'CONTROL_TIMESTEP o', &
    ' DTINIT:f>=0 TSSFAC:f=0.9>=0 ISDO:i|0|1 TSLIMT:fw DT2MS:f LCTM:i>=0 ERODE:i|0|1 MS1ST:i|0|1', &
    ' DT2MSF:fw DT2MSLC:iw IMSCL:iw -:x -:x RMSCL:fw EMSCL:fw IHDO:iw', &
    ' -:x IGADO:iw', &
    'CONTROL_DYNAMIC_RELAXATION o', &
    ' NRCYCK:i=250>=1 DRTOL:f=0.001>0<1 DRFCTR:f=0.995>0<1 DRTERM:f>=0 TSSFDR:f>=0 IRELAL:ir' &
    //' EDTTL:fs=0.04 IDRFLG:i|0|1|-999', &
    'CONTROL_HOURGLASS o', &
    ' IHQ:i QH:f>=0<=10', &
    'CONTROL_SHELL o', &
    ' WRPANG:fs=20 ESORT:is IRNXX:is=-1 ISTUPD:i THEORY:is=2 BWC:is=2 MITER:is=1 PROJ:is', &
    ' ROTASCL:fs=1 INTGRD:is LAMSHT:is CSTYP6:is=1 THSHEL:is', &
    ' PSTUPD:i SIDT4TU:is CNTCO:is ITSFLG:is IRQUAD:is=3 WMODE:fs STRETCH:fs ICRQ:is', &
    ' NFAIL1:is NFAIL4:is PSNFAIL:is KEEPCS:is DELFR:is DRCPSID:is DRCPRM:fs=1 INTPERR:is', &
    ' DRCMTH:is LISPSID:is NLOCDT:is', &
    'CONTROL_BULK_VISCOSITY o', &
    ' Q1:f~1.5>=0<=100 Q2:f~0.06>=0<=100 TYPE:i=1|-1|0|1 BTYPE:iw TSTYPE:iw', &
    'CONTROL_CONTACT o', &
    ' SLSFAC:f=0.1>=0 RWPNAL:fs ISLCHK:is SHLTHK:is PENOPT:iw=1 THKCHG:is ORIEN:is ENMASS:iw', &
    ' USRSTR:iw USRFRC:iw NSBCS:is INTERM:is XPENE:fs SSTHK:is ECDT:i|0|1|2 TIEDPRJ:is', &
    ' SFRIC:f>=0 DFRIC:f>=0 EDC:f>=0 VFC:f>=0 TH:fs TH_SF:fs PEN_SF:fs', &
    ' IGNORE:iw FRCENG:is SKIPRWG:is OUTSEG:is SPOTSTP:is SPOTDEL:is SPOTHIN:fs', &
    ' ISYM:is NSEROD:is RWGAPS:is RWGDTH:fs RWKSF:fs ICOV:is SWRADF:fs ITHOFF:is', &
    ' SHLEDG:is PSTIFF:is ITHCNT:is TDCNOF:is FTALL:is -:x SHLTRW:fs IGACTC:is', &
    'CONTROL_SOLUTION o', &
    ' SOLN:ir NLQ:is ISNAN:is LCINT:is LCACC:is NCDCF:is NOCOP:is', &
    'CONTROL_UNITS o', &
    ' LENGTH:a TIME:a MASS:a TEMP:as', &
    'CONTROL_ENERGY o', &
    ' HGEN:is RWEN:is SLNTEN:is RYLEN:is IRGEN:is MATEN:is DRLEN:is DISEN:is', &
    'CONTROL_OUTPUT o', &
    ' NPOPT:is NEECHO:is NREFUP:is IACCOP:iw OPIFS:fs IPNINT:is IKEDIT:i>=0 IFLUSH:is', &
    ' IPRTF:is IERODE:is TET10S8:is MSGMAX:is IPCURV:is GMDT:fs IP1DBLT:is EOCS:is', &
    ' TOLEV:is NEWLEG:is FRFREQ:is MINFO:is SOLSIG:is MSGFLG:is CDETOL:fs', &
    ' PHSCHNG:is DEMDEN:is ICRFILE:is SPC2BND:is PENOUT:is SHLSIG:is HISNOUT:is ENGOUT:is', &
    ' INSF:is ISOLSF:is IBSF:is ISSF:is MLKBAG:is', &
    'CONTROL_IMPLICIT_GENERAL o', &
    ' IMFLAG:i|0|1 DT0:f IMFORM:is NSBS:is IGS:is CNSTN:iw FORM:is ZERO_V:iw', &
    'CONTROL_IMPLICIT_DYNAMICS o', &
    ' IMASS:i|0|1 GAMMA:f BETA:f TDYBIR:fr TDYDTH:fr=1e28 TDYBUR:fr=1e28 IRATE:iw' &
    //' ALPHA:f>=-0.3333333333333333<=0', &
    ' PSID:ir ANGLE:fs', &
    'CONTROL_IMPLICIT_SPECTRAL_RADIUS o', &
    ' RHO:f>=0<=1', &
    'CONTROL_IMPLICIT_SOLUTION o', &
    ' NSOLVR:i=12|0|1|12 ILIMIT:is MAXREF:i=15>=0 DCTOL:f>=0 ECTOL:f=1e-20>=0 RCTOL:f=1e10>=0' &
    //' LSTOL:f=0.9>=0 ABSTOL:fw', &
    ' DNORM:is DIVERG:is ISTIF:is NLPRINT:is NLNORM:fs D3ITCTL:iw CPCHK:is', &
    ' DMTOL:fw EMTOL:fw RMTOL:fw -:x NTTOL:fw NRTOL:fw RTTOL:fw RRTOL:fw', &
    ' ARCCTL:ir ARCDIR:is ARCLEN:fs ARCMTH:is ARCDMP:is ARCPSI:fs ARCALF:fs ARCTIM:fs', &
    ' LSMTD:is LSDIR:is IRAD:fs SRAD:fs AWGT:fs SRED:fs', &
    'CONTROL_IMPLICIT_AUTO o', &
    ' IAUTO:i|0|1 ITEOPT:i=11>=1 ITEWIN:i=5>=0 DTMIN:f>=0 DTMAX:f>=0 DTEXP:fw KFAIL:iw KCYCLE:iw', &
    ' HCMIN:fw HCMAX:fw HMMIN:fw HMMAX:fw HNTMAX:fw HNRMAX:fw HRTMAX:fw HRRMAX:fw']

  !> Mesh, parts, materials, curves, sets.
  character(131), parameter :: table_mesh(*) = [character(131) :: &
    'NODE o', &
    ' NID:i8>=1 X:f16>=-1e30<=1e30 Y:f16>=-1e30<=1e30 Z:f16 TC:i8>=0<=7 RC:is8', &
    'ELEMENT_SHELL o', &
    ' EID:i8>=1 PID:i8>=1 N1:i8>=1 N2:i8>=1 N3:i8>=1 N4:i8>=0 N5:ir8 N6:ir8 N7:ir8 N8:ir8', &
    'ELEMENT_BEAM o', &
    ' EID:is8 PID:i8>=1 N1:i8>=1 N2:i8>=1 N3:is8 RT1:is8 RR1:is8 RT2:is8 RR2:is8 LOCAL:is8', &
    'ELEMENT_MASS r', &
    ' EID:is8 NID:i8>=1 MASS:f16>=0 PID:is8', &
    'ELEMENT_MASS_NODE_SET r', &
    ' EID:is8 NSID:i8>=1 MASS:f16>=0 PID:is8', &
    'PART tr', &
    ' HEADING:a80', &
    ' PID:i>=1 SECID:i>=1 MID:i>=1 EOSID:i>=0 HGID:i>=0 GRAV:iw ADPOPT:iw TMID:iw', &
    'PART_INERTIA r', &
    ' HEADING:a80', &
    ' PID:i>=1 SECID:i>=1 MID:i>=1 EOSID:i>=0 HGID:i>=0 GRAV:iw ADPOPT:iw TMID:iw', &
    ' XC:f YC:f ZC:fs TM:f>0<=1e30 IRCS:i|0|1 NODEID:i>=0', &
    ' IXX:fs IXY:fs IXZ:fs IYY:fs IYZ:fs IZZ:f>0<=1e30', &
    ' VTX:f VTY:f VTZ:fw VRX:fw VRY:fw VRZ:f', &
    ' XL:fs YL:fs ZL:fs XLIP:fs YLIP:fs ZLIP:fs CID:is', &
    'SECTION_SHELL t', &
    ' SECID:i>=1 ELFORM:i=2 SHRF:fs NIP:i|0|1|2|4 PROPT:fs QR_IRID:is ICOMP:ir SETYP:ir=1', &
    ' T1:f T2:f T3:f T4:f NLOC:fs MAREA:fs IDOF:fs EDGSET:is', &
    'HOURGLASS t', &
    ' HGID:i>=1 IHQ:i QM:f>=0<=10 IBQ:is Q1:f>=0<=100 Q2:f>=0<=100 QB_VDC:fs QW:fs', &
    'MAT_ELASTIC t', &
    ' MID:i>=1 RO:f>=1e-30<=1e30 E:f>=1e-30<=1e30 PR:f>-1<0.5 DA:fw DB:fw', &
    'MAT_PLASTIC_KINEMATIC t', &
    ' MID:i>=1 RO:f>=1e-30<=1e30 E:f>=1e-30<=1e30 PR:f>-1<0.5 SIGY:f>0 ETAN:f>=0 BETA:f>=0<=1', &
    ' SRC:fr SRP:fr FS:f>=0 VP:fw', &
    'MAT_PIECEWISE_LINEAR_PLASTICITY t', &
    ' MID:i>=1 RO:f>=1e-30<=1e30 E:f>=1e-30<=1e30 PR:f>-1<0.5 SIGY:f>=0 ETAN:f>=0 FAIL:f>=0' &
    //' TDEL:fr', &
    ' C:f>=0 P:f>=0 LCSS:i>=0 LCSR:i>=0 VP:f|0|1', &
    ' EPS1:f EPS2:f EPS3:f EPS4:f EPS5:f EPS6:f EPS7:f EPS8:f', &
    ' ES1:f ES2:f ES3:f ES4:f ES5:f ES6:f ES7:f ES8:f', &
    'MAT_NULL t', &
    ' MID:i>=1 RO:f>=1e-30<=1e30 PC:f<=0 MU:f>=0<=1e30 TEROD:fr CEROD:fr YM:fs PR:fs', &
    'MAT_ELASTIC_PLASTIC_HYDRO t', &
    ' MID:i>=1 RO:f>=1e-30<=1e30 G:f>=1e-30<=1e30 SIGY:f>=0 EH:f>=0 PC:f<=0 FS:f>=0 CHARL:fr', &
    ' EPS1:f EPS2:f EPS3:f EPS4:f EPS5:f EPS6:f EPS7:f EPS8:f', &
    ' EPS9:f EPS10:f EPS11:f EPS12:f EPS13:f EPS14:f EPS15:f EPS16:f', &
    ' ES1:f ES2:f ES3:f ES4:f ES5:f ES6:f ES7:f ES8:f', &
    ' ES9:f ES10:f ES11:f ES12:f ES13:f ES14:f ES15:f ES16:f', &
    'MAT_JOHNSON_COOK t', &
    ' MID:i>=1 RO:f>=1e-30<=1e30 G:f>=1e-30<=1e30 E:f>=0<=1e30 PR:f>-1<0.5 DTF:fr VP:f|0|1' &
    //' RATEOP:fr', &
    ' A:f>0 B:f>=0 N:f>=0 C:f>=0 M:f TM:f TR:f EPSO:f>0', &
    ' CP:f>=0 PC:f<=0 SPALL:f=2|1|2|3 IT:fs D1:f D2:f D3:f D4:f', &
    ' D5:f C2_P_XNP_D:fr EROD:f EFMIN:f=1e-6>=0 NUMINT:fr K:fr EPS1:fr', &
    'MAT_SIMPLIFIED_JOHNSON_COOK t', &
    ' MID:i>=1 RO:f>=1e-30<=1e30 E:f>=1e-30<=1e30 PR:f>-1<0.5 VP:f|0|1', &
    ' A:f>0 B:f>=0 N:f>=0 C:f>=0 PSFAIL:f=1e17>=0 SIGMAX:f=1e28 SIGSAT:f=1e28 EPSO:f=1>0', &
    'MAT_VISCOELASTIC t', &
    ' MID:i>=1 RO:f>=1e-30<=1e30 BULK:f>=1e-30<=1e30 G0:f>=1e-30<=1e30 GI:f>=0<=1e30' &
    //' BETA:f>=0<=1e30', &
    'MAT_MOONEY-RIVLIN_RUBBER t', &
    ' MID:i>=1 RO:f>=1e-30<=1e30 PR:f>0<0.5 A:f>=0<=1e30 B:f>=0<=1e30 REF:fr', &
    ' SGL:fr SW:fr ST:fr LCID:ir', &
    'MAT_OGDEN_RUBBER t', &
    ' MID:i>=1 RO:f>=1e-30<=1e30 PR:f>0<0.5 N:ir NV:is G:fr SIGF:fr REF:fr', &
    ' MU1:f MU2:f MU3:f MU4:f MU5:f MU6:f MU7:f MU8:f', &
    ' ALPHA1:f ALPHA2:f ALPHA3:f ALPHA4:f ALPHA5:f ALPHA6:f ALPHA7:f ALPHA8:f', &
    ' GI:fr BETAI:fr VFLAG:is', &
    'MAT_BLATZ-KO_RUBBER t', &
    ' MID:i>=1 RO:f>=1e-30<=1e30 G:f>=1e-30<=1e30 REF:fr', &
    'MAT_CRUSHABLE_FOAM t', &
    ' MID:i>=1 RO:f>=1e-30<=1e30 E:f>=1e-30<=1e30 PR:f>-1<0.5 LCID:i>=1 TSC:f>=0 DAMP:fw' &
    //' MODEL:ir', &
    'MAT_ADD_EROSION t', &
    ' MID:i>=1 EXCL:f MXPRES:f MNEPS:f EFFEPS:f VOLEPS:f NUMFIP:f=1>=0<=4 NCS:f=1>=0', &
    ' MNPRES:f SIGP1:f SIGVM:f MXEPS:f EPSSH:f SIGTH:f IMPULSE:f FAILTM:f', &
    ' IDAM:ir -:x -:x -:x -:x -:x -:x LCREGD:ir', &
    ' LCFLD:ir NSFF:is=10 EPSTHIN:fr ENGCRT:fr RADCRT:fr LCEPS12:ir LCEPS13:ir LCEPSMX:ir', &
    ' DTEFLT:fw VOLFRAC:fw MXTMP:fr DTMIN:f>=0', &
    'EOS_LINEAR_POLYNOMIAL t', &
    ' EOSID:i>=1 C0:f>=-1e30<=1e30 C1:f>=-1e30<=1e30 C2:f>=-1e30<=1e30 C3:f>=-1e30<=1e30' &
    //' C4:f>=-100<=100 C5:f>=-100<=100 C6:f>=-100<=100', &
    ' E0:f>=-1e30<=1e30 V0:f=1>=1<=1', &
    'EOS_GRUNEISEN t', &
    ' EOSID:i>=1 C:f>0<=1e12 S1:f>=-100<=100 S2:f>=-100<=100 S3:f>=-100<=100 GAMAO:f>=0<=100' &
    //' A:f>=-100<=100 E0:f>=-1e30<=1e30', &
    ' V0:f=1>=1<=1 -:x LCID:ir', &
    'MAT_RIGID t', &
    ' MID:i>=1 RO:f>=1e-30<=1e30 E:f>=1e-30<=1e30 PR:f>-1<0.5 N:fr COUPLE:fr M:fr ALIAS:ar', &
    ' CMO:i|0|1|-1 CON1:i CON2:i', &
    ' LCO_OR_A1:fw A2:fw A3:fw V1:fw V2:fw V3:fw', &
    'DEFINE_CURVE t', &
    ' LCID:i>=1 SIDR:i|0|1|2 SFA:f=1>=0 SFO:f=1 OFFA:f OFFO:f DATTYP:is LCINT:is', &
    ' A1:f20 O1:f20', &
    'DEFINE_CURVE_FUNCTION t', &
    ' LCID:i>=1 SIDR:i|0', &
    ' FUNCTION:a80', &
    'DEFINE_COORDINATE_SYSTEM t', &
    ' CID:i>=1 XO:f YO:f ZO:f XL:f YL:f ZL:f CIDL:ir', &
    ' XP:f YP:f ZP:f', &
    'DEFINE_BOX t', &
    ' BOXID:i>=1 XMN:f XMX:f YMN:f YMX:f ZMN:fs ZMX:fs', &
    'DEFINE_TABLE t', &
    ' TBID:i>=1 SFA:f=1>=0 OFFA:f', &
    ' VALUE:f20', &
    'SET_NODE_LIST t', &
    ' SID:i>=1 DA1:fs DA2:fs DA3:fs DA4:fs SOLVER:as ITS:as', &
    ' NID1:i NID2:i NID3:i NID4:i NID5:i NID6:i NID7:i NID8:i', &
    'SET_NODE_LIST_GENERATE t', &
    ' SID:i>=1 DA1:fs DA2:fs DA3:fs DA4:fs SOLVER:as ITS:as', &
    ' B1BEG:i B1END:i B2BEG:i B2END:i B3BEG:i B3END:i B4BEG:i B4END:i', &
    'SET_NODE_GENERAL t', &
    ' SID:i>=1 DA1:fs DA2:fs DA3:fs DA4:fs SOLVER:as ITS:as', &
    ' OPTION:a E1:i E2:i E3:i E4:i E5:i E6:i E7:i', &
    'SET_PART_LIST t', &
    ' SID:i>=1 DA1:fs DA2:fs DA3:fs DA4:fs SOLVER:as', &
    ' PID1:i PID2:i PID3:i PID4:i PID5:i PID6:i PID7:i PID8:i', &
    'SET_PART_LIST_GENERATE t', &
    ' SID:i>=1 DA1:fs DA2:fs DA3:fs DA4:fs SOLVER:as', &
    ' B1BEG:i B1END:i B2BEG:i B2END:i B3BEG:i B3END:i B4BEG:i B4END:i', &
    'SET_PART_ADD t', &
    ' SID:i>=1 DA1:fs DA2:fs DA3:fs DA4:fs SOLVER:as', &
    ' PSID1:i PSID2:i PSID3:i PSID4:i PSID5:i PSID6:i PSID7:i PSID8:i', &
    'SET_SHELL_LIST t', &
    ' SID:i>=1 DA1:fs DA2:fs DA3:fs DA4:fs', &
    ' EID1:i EID2:i EID3:i EID4:i EID5:i EID6:i EID7:i EID8:i', &
    'SET_SHELL_LIST_GENERATE t', &
    ' SID:i>=1 DA1:fs DA2:fs DA3:fs DA4:fs', &
    ' B1BEG:i B1END:i B2BEG:i B2END:i B3BEG:i B3END:i B4BEG:i B4END:i', &
    'SET_SEGMENT t', &
    ' SID:i>=1 DA1:fs DA2:fs DA3:fs DA4:fs SOLVER:as ITS:as', &
    ' N1:i>=1 N2:i>=1 N3:i N4:i A1:fs A2:fs A3:fs A4:fs', &
    'SET_SEGMENT_GENERAL t', &
    ' SID:i>=1 DA1:fs DA2:fs DA3:fs DA4:fs SOLVER:as ITS:as', &
    ' OPTION:a E1:i E2:i E3:i E4:i E5:i E6:i E7:i', &
    'SET_2D_SEGMENT t', &
    ' SID:i>=1 DA1:fs DA2:fs DA3:fs DA4:fs', &
    ' PID:i', &
    'SET_2D_SEGMENT_SET t', &
    ' SID:i>=1 DA1:fs DA2:fs DA3:fs DA4:fs', &
    ' PSID:i']

  !> Constraints, loads, initial values.
  character(92), parameter :: table_conditions(*) = [character(92) :: &
    'BOUNDARY_SPC_NODE tr', &
    ' NID:i>=1 CID:i DOFX:i|0|1 DOFY:i|0|1 DOFZ:is DOFRX:is DOFRY:is DOFRZ:is', &
    'BOUNDARY_SPC_SET tr', &
    ' NSID:i>=1 CID:i DOFX:i|0|1 DOFY:i|0|1 DOFZ:is DOFRX:is DOFRY:is DOFRZ:is', &
    'BOUNDARY_PRESCRIBED_MOTION_NODE tr', &
    ' NID:i>=1 DOF:i|1|2 VAD:i|0|1|2 LCID:i>=1 SF:f=1 VID:ir DEATH:f=1e28 BIRTH:f', &
    'BOUNDARY_PRESCRIBED_MOTION_SET tr', &
    ' NSID:i>=1 DOF:i|1|2 VAD:i|0|1|2 LCID:i>=1 SF:f=1 VID:ir DEATH:f=1e28 BIRTH:f', &
    'BOUNDARY_PRESCRIBED_MOTION_RIGID tr', &
    ' PID:i>=1 DOF:i|1|2|7 VAD:i|0|1|2 LCID:i>=1 SF:f=1 VID:ir DEATH:f=1e28 BIRTH:f', &
    'INITIAL_STRESS_SHELL r', &
    ' EID:i>=1 NPLANE:i=1|1|4 NTHICK:i=1|1 NHISV:i>=0 NTENSR:ir LARGE:i|0|1 NTHINT:ir NTHHSV:ir', &
    ' T:fs SIGXX:f SIGYY:f SIGZZ:f SIGXY:f SIGYZ:fr SIGZX:fr EPS:f', &
    ' HISV1:f HISV2:f HISV3:f HISV4:f HISV5:f HISV6:f HISV7:f HISV8:f', &
    ' T:fs16 SIGXX:f16 SIGYY:f16 SIGZZ:f16 SIGXY:f16', &
    ' SIGYZ:fr16 SIGZX:fr16 EPS:f16', &
    ' HISV1:f16 HISV2:f16 HISV3:f16 HISV4:f16 HISV5:f16', &
    'INITIAL_STRAIN_SHELL r', &
    ' EID:i>=1 NPLANE:i=1|1|4 NTHICK:i=1|1 LARGE:i|0|1', &
    ' EPSXX:f EPSYY:f EPSZZ:f EPSXY:f EPSYZ:fs EPSZX:fs T:fs', &
    ' EPSXX:f16 EPSYY:f16 EPSZZ:f16 EPSXY:f16 EPSYZ:fs16', &
    ' EPSZX:fs16 T:fs16', &
    'INITIAL_VELOCITY o', &
    ' NSID:i>=0 NSIDEX:i>=0 BOXID:i>=0 IRIGID:i ICID:ir', &
    ' VX:f VY:f VZ:fw VXR:fw VYR:fw VZR:fw', &
    ' VXE:f VYE:f VZE:fw VXRE:fw VYRE:fw VZRE:fw', &
    'INITIAL_VELOCITY_NODE r', &
    ' NID:i>=1 VX:f VY:f VZ:fw VXR:fw VYR:fw VZR:fw ICID:ir', &
    'INITIAL_VELOCITY_GENERATION', &
    ' ID:i>=0 STYP:i~1|1|2|3 OMEGA:f>=-1e30<=1e30 VX:f VY:f VZ:fw IVATN:is ICID:ir', &
    ' XC:f YC:f ZC:fs NX:f NY:f NZ:f PHASE:ir IRIGID:i', &
    'INITIAL_VELOCITY_RIGID_BODY r', &
    ' PID:i>=1 VX:f VY:f VZ:fw VXR:fw VYR:fw VZR:f ICID:ir', &
    'LOAD_NODE_POINT r', &
    ' NID:i>=1 DOF:i|1|2 LCID:i>=1 SF:f=1 CID:i M1:is M2:is M3:is', &
    'LOAD_NODE_SET r', &
    ' NSID:i>=1 DOF:i|1|2 LCID:i>=1 SF:f=1 CID:i M1:is M2:is M3:is', &
    'LOAD_RIGID_BODY r', &
    ' PID:i>=1 DOF:i~1|1|2|7 LCID:i>=1 SF:f=1 CID:i M1:is M2:is M3:is', &
    'LOAD_SEGMENT tr', &
    ' LCID:i>=1 SF:f=1 AT:f>=0 N1:i>=1 N2:i>=1 N3:i N4:i N5:ir', &
    'LOAD_SEGMENT_SET tr', &
    ' SSID:i>=1 LCID:i>=1 SF:f=1 AT:f>=0', &
    'LOAD_BODY_X r', &
    ' LCID:i>=1 SF:f=1 LCIDDR:iw XC:fs YC:fs ZC:fs CID:ir', &
    'LOAD_BODY_Y r =LOAD_BODY_X', &
    'RIGIDWALL_PLANAR t', &
    ' NSID:i>=0 NSIDEX:i>=0 BOXID:ir OFFSET:f>=0 BIRTH:f DEATH:f=1e20 RWKSF:fs=1', &
    ' XT:f YT:f ZT:f XH:f YH:f ZH:f FRIC:f WVEL:fr', &
    'RIGIDWALL_PLANAR_MOVING t', &
    ' NSID:i>=0 NSIDEX:i>=0 BOXID:ir OFFSET:f>=0 BIRTH:f DEATH:f=1e20 RWKSF:fs=1', &
    ' XT:f YT:f ZT:f XH:f YH:f ZH:f FRIC:f WVEL:fr', &
    ' MASS:f>0<=1e30 V0:f', &
    'DAMPING_GLOBAL r', &
    ' LCID:i>=0 VALDMP:f>=0 STX:f>=0 STY:f>=0 STZ:fs SRX:fs SRY:fs SRZ:fs', &
    'DAMPING_PART_MASS r', &
    ' PID:i>=1 LCID:i>=1 SF:f=1>=0 FLAG:i|0|1', &
    ' STX:f>=0 STY:f>=0 STZ:fs SRX:fs SRY:fs SRZ:fs', &
    'DAMPING_PART_MASS_SET r', &
    ' PSID:i>=1 LCID:i>=1 SF:f=1>=0 FLAG:i|0|1', &
    ' STX:f>=0 STY:f>=0 STZ:fs SRX:fs SRY:fs SRZ:fs', &
    'DAMPING_PART_STIFFNESS r', &
    ' PID:i>=1 COEF:f<=1', &
    'DAMPING_PART_STIFFNESS_SET r', &
    ' PSID:i>=1 COEF:f<=1', &
    'CONSTRAINED_NODE_SET tr', &
    ' NSID:i>=1 DOF:i~1>=1<=7 TF:fr=1e20', &
    'CONSTRAINED_ADAPTIVITY r', &
    ' DNID:i>=1 NID1:i>=1 NID2:i>=1']

  !> Contact interfaces.
  character(104), parameter :: table_contact(*) = [character(104) :: &
    'CONTACT_2D_SLIDELINE t', &
    ' SURFA:i SURFB:i CTYPE:i NGAUSS:i=2>=1<=10 PEN:f FS:f>=0 FD:f>=0 DC:f>=0', &
    ' TBIRTH:f TDEATH:f=1e20 PUNIT:i|0|1|2|3|4 PENT:f>=0 VDC:f>=0<=100 IPF:i|0|1' &
    //' FREQ:i>=0<=1000000000 SRCH:f', &
    ' VC:f>=0 TFAC:f=1>0<=1 TIE:i|0|1|2 NFLS:f SFLS:f LCINT:i>=0 TARGET:f>=0<1' &
    //' SMOOTH:i>=-1<=89', &
    'CONTACT_2D_PENALTY t', &
    ' SURFA:i SURFB:i TBIRTH:f TDEATH:f=1e20', &
    ' EXT_PAS:iw THETA1:fw THETA2:fw TOL_IG:fw=1e-3 PEN:f=0.1>=0 TOLOFF:fw=0.25 FRCSCL:fw=0.1' &
    //' ONEWAY:fr', &
    'CONTACT_2D_SLIDING_VOIDS t =CONTACT_2D_PENALTY', &
    'CONTACT_2D_PENALTY_FRICTION t', &
    ' SURFA:i SURFB:i TBIRTH:f TDEATH:f=1e20', &
    ' EXT_PAS:iw THETA1:fw THETA2:fw TOL_IG:fw=1e-3 PEN:f=0.1>=0 TOLOFF:fw=0.25 FRCSCL:fw=0.1' &
    //' ONEWAY:fr', &
    ' FRIC:f>=0 FRIC_L:f>=0 FRIC_H:f>=0 FRIC_S:fr', &
    'CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE t', &
    ' SURFA:i SURFB:i SFACT:f=1>=0 FREQ:i>=0<=1000000000 FS:f>=0 FD:f>=0 DC:f>=0', &
    ' TBIRTH:f TDEATH:f=1e20 SOA:fw=1 SOB:fw=1 NDA:iw NDB:iw COF:iw INIT:iw', &
    ' VC:f>=0 VDC:f~10>=0<=100 IPF:iw SLIDE:iw ISTIFF:iw TIEDGAP:fs IGAPCL:is TIETYP:is', &
    ' SLDSOA:fr SLDSOB:fr TDPEN:fw', &
    'CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE_MORTAR t =CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE', &
    'CONTACT_2D_AUTOMATIC_NODE_TO_SURFACE t =CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE', &
    'CONTACT_2D_AUTOMATIC_SINGLE_SURFACE t', &
    ' SURFA:i SURFB:iw SFACT:f=1>=0 FREQ:i>=0<=1000000000 FS:f>=0 FD:f>=0 DC:f>=0', &
    ' TBIRTH:f TDEATH:f=1e20 SOA:fw=1 SOB:fw=1 NDA:iw NDB:iw COF:iw INIT:iw', &
    ' VC:f>=0 VDC:f~10>=0<=100 IPF:iw SLIDE:iw ISTIFF:iw TIEDGAP:fs IGAPCL:is TIETYP:is', &
    ' SLDSOA:fr SLDSOB:fr TDPEN:fw', &
    'CONTACT_2D_AUTOMATIC_SINGLE_SURFACE_MORTAR t =CONTACT_2D_AUTOMATIC_SINGLE_SURFACE', &
    'CONTACT_2D_AUTOMATIC_ONE_WAY_SURFACE_TO_SURFACE t =CONTACT_2D_AUTOMATIC_SURFACE_TO_SURFACE', &
    'CONTACT_2D_FORCE_TRANSDUCER t', &
    ' SURFA:i SURFB:ir SFACT:fs=1 FREQ:is FS:fs FD:fs DC:fs', &
    ' TBIRTH:fw TDEATH:fw=1e20 SOA:fs=1 SOB:fs=1 NDA:is NDB:is COF:is INIT:is', &
    'CONTACT_2D_AUTOMATIC_TIED t', &
    ' SURFA:i SURFB:i SFACT:f=1>=0 FREQ:iw FS:fw FD:fw DC:fw', &
    ' TBIRTH:f TDEATH:f=1e20 SOA:fw=1 SOB:fw=1 NDA:iw NDB:iw COF:iw INIT:iw', &
    ' VC:fw VDC:fw=10 IPF:iw SLIDE:iw ISTIFF:iw TIEDGAP:f IGAPCL:ir TIETYP:is', &
    ' SLDSOA:fr SLDSOB:fr TDPEN:fw', &
    'CONTACT_2D_AUTOMATIC_TIED_ONE_WAY t =CONTACT_2D_AUTOMATIC_TIED', &
    'CONTACT_2D_TIED_SLIDING t =CONTACT_2D_PENALTY']

  !> Output.
  character(88), parameter :: table_database(*) = [character(88) :: &
    'DATABASE_GLSTAT', &
    ' DT:f>=0 BINARY:i|0|1|2|3 LCUR:i>=0 IOOPT:is OPTION1:fs OPTION2:is', &
    'DATABASE_MATSUM =DATABASE_GLSTAT', &
    'DATABASE_RCFORC =DATABASE_GLSTAT', &
    'DATABASE_NODOUT =DATABASE_GLSTAT', &
    'DATABASE_RWFORC =DATABASE_GLSTAT', &
    'DATABASE_SLEOUT =DATABASE_GLSTAT', &
    'DATABASE_SPCFORC =DATABASE_GLSTAT', &
    'DATABASE_ELOUT', &
    ' DT:f>=0 BINARY:i|0|1|2|3 LCUR:i>=0 IOOPT:is OPTION1:is OPTION2:iw OPTION3:is OPTION4:is', &
    'DATABASE_RBDOUT =DATABASE_GLSTAT', &
    'DATABASE_BNDOUT =DATABASE_GLSTAT', &
    'DATABASE_NODFOR =DATABASE_GLSTAT', &
    'DATABASE_SECFORC =DATABASE_GLSTAT', &
    'DATABASE_BINARY_D3PLOT', &
    ' DT:f>=0 LCDT:i>=0 BEAM:is NPLTC:i>=0 PSETID:iw', &
    ' IOOPT:is RATE:fs CUTOFF:fs WINDOW:fs TYPE:is PSET:iw', &
    'DATABASE_BINARY_D3DUMP', &
    ' CYCL:i>=0<=2e9 NR:is BEAM:is NPLTC:iw PSETID:iw', &
    'DATABASE_BINARY_RUNRSF', &
    ' CYCL:i>=0<=2e9 NR:iw=1 BEAM:is NPLTC:iw PSETID:iw', &
    'DATABASE_ERROR_INDICATOR o', &
    ' NORM:i=1|0|1', &
    'DATABASE_HISTORY_NODE r', &
    ' ID1:i ID2:i ID3:i ID4:i ID5:i ID6:i ID7:i ID8:i', &
    'DATABASE_HISTORY_NODE_ID r', &
    ' ID1:i HEADING:as70', &
    'DATABASE_HISTORY_NODE_SET r =DATABASE_HISTORY_NODE', &
    'DATABASE_HISTORY_SHELL r =DATABASE_HISTORY_NODE', &
    'DATABASE_HISTORY_SHELL_SET r =DATABASE_HISTORY_NODE', &
    'DATABASE_NODAL_FORCE_GROUP r', &
    ' NSID:i>=1 CID:ir', &
    'DATABASE_CROSS_SECTION_SET tr', &
    ' NSID:i>=1 HSID:ir BSID:ir SSID:i>=1 TSID:ir DSID:ir ID:ir ITYPE:is', &
    'INTERFACE_SPRINGBACK_LSDYNA', &
    ' PSID:i>=0 NSHV:i>=0<=100 FTYPE:i|0|10 -:x FTENSR:ir NTHHSV:ir RFLAG:iw INTSTRN:is', &
    ' OPTC:a SLDO:is NCYC:ir FSPLIT:ir NDFLAG:i|0|1 CFLAG:iw HFLAG:is', &
    ' NID:i>=1 TC:i>=0<=7 RC:is', &
    'INTERFACE_SPRINGBACK_EXCLUDE', &
    ' KWDNAME:a80']

end module deck_schema_tables_m
